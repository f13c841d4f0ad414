// Panels of the page: picture, buttons, table of numbers; and the selection.

function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else if (value !== null) element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

// A table that scrolls sideways, also by keys.
const scrolling = (label, table) => make('div', {class: 'scroll', tabindex: '0', role: 'group', 'aria-label': label}, table);

// Two distinct numbers, further apart than rounding errors.
const isRange = (range) => Array.isArray(range) && range.length === 2 && range.every(Number.isFinite) &&
  range[1] - range[0] > 1e-9 * Math.max(Math.abs(range[0]), Math.abs(range[1]));

const isNumber = (words) => /^[−–\d]/.test(words);

const mostColumnsNarrow = 4;  // rows of a table with more columns are lists in narrow windows

function fillTable(table, {headers, rows}) {
  const head = make('tr', {}, ...headers.map((words, i) => words === '' ? make('td') :
    make('th', {scope: 'col', class: i && rows.some((row) => isNumber(row[i])) ? 'number' : null}, words)));
  const body = rows.map((row) => make('tr', {}, ...row.map((words, i) =>
    i ? make('td', {'class': isNumber(words) ? 'number' : null, 'data-header': headers[i]}, words) : make('th', {scope: 'row'}, words))));
  table.classList.toggle('list-if-narrow', headers.length > mostColumnsNarrow);
  table.replaceChildren(make('thead', {}, head), make('tbody', {}, ...body));
}

// Purposes of saved pictures: drawn width, in 96 pixels per inch, at which characters of 11.5 pixels are 8.6
// points, and displayed width.
const uses = {
  page: {words: 'a page, 180 mm', drawn: 680, shown: 680},
  column: {words: 'a column, 86 mm', drawn: 325, shown: 325},
  slide: {words: 'a slide, 1280 wide', drawn: 680, shown: 1280},
};

const overTime = ({kind}) => kind === 'time' || kind === 'strip';

// Whether a picture shows numbers that do not belong to samples, so that it does not follow the selection.
const ofAllSamples = ({kind}) => ['bars', 'curves', 'dots'].includes(kind);

const titleSize = 13;

// Title broken into lines, and their total height.
function titleLines(title, width) {
  const lines = wrapped(title, width, titleSize, 600);
  return {lines, height: 17 * lines.length + 7};
}

class Panel {
  constructor(item, section, report) {
    Object.assign(this, {item, section, report});
    this.canvas = make('canvas', {role: 'img'});
    this.picture = make('div', {class: 'picture'}, this.canvas);
    this.numbers = make('table');
    const tools = make('div', {class: 'tools'},
      make('button', {type: 'button', title: 'Save this picture as SVG', onclick: () => this.save('svg')}, 'SVG'),
      make('button', {type: 'button', title: 'Save this picture as PNG', onclick: () => this.save('png')}, 'PNG'));
    this.cross = make('div', {class: 'cross', hidden: ''});
    this.spot = make('div', {class: 'spot', hidden: ''});
    this.empty = make('p', {class: 'empty', hidden: ''});
    this.readout = make('p', {class: 'readout', 'aria-hidden': 'true'});
    this.picture.append(this.cross, this.spot, this.empty);
    tools.prepend(this.readout);
    section.querySelector('h2').after(tools, this.picture, this.choice());
    this.switches = this.makeSwitches();
    if (this.switches.length) this.picture.before(make('div', {class: 'chips', role: 'group', 'aria-label': 'Curves'}, ...this.switches));
    this.whole = make('p', {class: 'hint whole', hidden: ''}, 'This picture shows all samples.');
    this.picture.after(this.whole);
    if (item.kind === 'binned') section.querySelector('.caption')?.append(` ${barsText(item.autocorrelation_time)}`);
    section.append(make('details', {}, make('summary', {}, 'Numbers'), scrolling(`Numbers of ${item.title}`, this.numbers)));
  }

  choice() {
    if (!(this.item.x_choices?.length > 1)) return '';
    const options = this.item.x_choices.map((name) =>
      make('option', {value: name}, this.report.samples.columns.get(name).title));
    this.select = make('select', {onchange: () => {
      this.item.choice = this.select.value;
      this.changed();
    }}, ...options);
    return make('label', {class: 'choice'}, 'Horizontal axis', this.select);
  }

  // Buttons that switch curves off and on, if there are several; one curve always remains.
  makeSwitches() {
    const {item, report} = this;
    if (!['time', 'binned', 'quantiles'].includes(item.kind) || item.columns.length < 2) return [];
    item.hidden = new Set();
    return columnsOf(report.samples, item.columns).map(({name, title}) => make('button', {
      'type': 'button', 'class': 'chip', 'onclick': () => {
        if (!item.hidden.delete(name) && item.hidden.size + 1 < item.columns.length) item.hidden.add(name);
        this.changed();
      },
    }, make('span', {class: 'swatch'}), title));
  }

  get height() {
    const own = heights[this.item.kind];
    if (own) return own(this.item, this.report.samples, this.width);
    const {screen, print} = this.item.kind === 'time' ? {screen: 280, print: 200} : {screen: 380, print: 300};
    return this.report.printing ? print : screen;
  }

  draw() {
    const {samples, theme, sharpness} = this.report;
    // A sheet of paper is 680 pixels wide; wider drawings are reduced, including text.
    const width = this.report.printing ? 680 : Math.max(Math.round(this.picture.clientWidth), 280);
    this.width = width;
    this.canvas.width = width * sharpness;
    this.canvas.height = this.height * sharpness;
    this.canvas.style.aspectRatio = `${width} / ${this.height}`;
    const context = this.canvas.getContext('2d');
    context.scale(sharpness, sharpness);
    const named = this.switches.length > 0 && !this.report.printing;
    this.drawn = drawPicture(new CanvasPen(context), width, this.height, this.item, samples, {...theme, named});
    const {alternative, points, table} = this.drawn;
    this.switches.forEach((button, i) => {
      button.setAttribute('aria-pressed', String(!this.item.hidden.has(this.item.columns[i])));
      button.querySelector('.swatch').style.background = theme.series[i % theme.series.length];
    });
    this.whole.hidden = !samples.isFiltered || !ofAllSamples(this.item);
    this.empty.hidden = points > 0;
    this.empty.textContent = samples.selectedCount ? 'No selected sample has a value here' : 'No sample is selected';
    this.point(this.report.cursor);
    this.canvas.setAttribute('aria-label', `${this.item.title}. ${alternative}. ${plural(points, 'point')}.`);
    fillTable(this.numbers, table);
  }

  // Call after a change of this picture alone.
  changed() {
    this.draw();
    this.report.remember();
  }

  // Whether curves are switched off, or the vertical axis is enlarged.
  get isChanged() { return this.item.hidden?.size > 0 || this.item.vertical !== undefined; }

  reset() {
    this.item.hidden?.clear();
    this.item.vertical = undefined;
  }

  // Columns of the readout.
  get told() {
    const {kind, columns, choice, x_choices: choices, x, y, latitude, longitude, colour} = this.item;
    if (overTime(this.item)) return this.item.uncertainty ? [...columns, this.item.uncertainty] : columns;
    if (kind === 'binned') return [choice ?? choices[0], ...columns];
    return [x, y, latitude, longitude, colour].filter((name) => name);
  }

  // Shows the position of sample `i` in this picture, and its values; undefined for no sample.
  point(i) {
    const {samples} = this.report;
    const {plot, place} = this.drawn;
    const shown = i !== undefined && place;
    this.readout.textContent = shown ? [`${clock(samples.time[i])} UTC`, ...columnsOf(samples, this.told)
      .map(({title, unit, values}) => `${title} ${brief(values[i])}${unit && !Number.isNaN(values[i]) ? ` ${unit}` : ''}`)].join('  ·  ') : '';
    const at = shown ? place(i) : {};
    const across = at.x >= plot.x && at.x <= plot.x + plot.width;
    const inside = across && at.y >= plot.y && at.y <= plot.y + plot.height;
    this.cross.hidden = !(across && overTime(this.item));
    this.spot.hidden = !inside || this.item.kind === 'strip';
    Object.assign(this.cross.style, {left: `${at.x}px`, top: `${plot.y}px`, height: `${plot.height}px`});
    Object.assign(this.spot.style, {left: `${at.x}px`, top: `${at.y}px`});
  }

  // Selected sample nearest to a position, within the width of a finger.
  nearest(x, y) {
    const {samples} = this.report;
    let found, least = 18 ** 2;
    for (let i = 0; i < samples.count; ++i) {
      if (!samples.selected[i]) continue;
      const at = this.drawn.place(i);
      const distance = (at.x - x) ** 2 + (at.y - y) ** 2;
      if (distance < least) [found, least] = [i, distance];
    }
    return found;
  }

  // Drawn width and height of the picture for its purpose, and displayed width.
  get exportSize() {
    const {drawn, shown} = uses[this.report.use];
    const half = this.item.kind === 'time' ? 0.4 : 0.6;
    const own = heights[this.item.kind];
    const height = own ? own(this.item, this.report.samples, drawn) : Math.max(Math.round(half * drawn), 240);
    return {width: drawn, height, shown};
  }

  // Picture on white, below its title, by a pen that `makePen` makes from its width, height and displayed width.
  drawForPaper(makePen) {
    const {width, height, shown} = this.exportSize, title = titleLines(this.item.title, width - 16);
    const pen = makePen(width, height + title.height, shown);
    cover(pen, width, height + title.height, palettes.light);
    title.lines.forEach((words, i) =>
      pen.text(8, 17 + 17 * i, words, {fill: palettes.light.ink, size: titleSize, weight: 600}));
    pen.below(title.height, () =>
      drawPicture(pen, width, height, this.item, this.report.samples, palettes.light));
    return pen;
  }

  svg() {
    return this.drawForPaper((width, height, shown) =>
      new SvgPen(width, height, this.item.title, shown, `${this.description} ${this.report.origin}`.trim())).svg;
  }

  png() {
    return this.drawForPaper((width, height, shown) => {
      const dotsPerPixel = 3 * Math.max(1, shown / width / 1.5);
      const canvas = make('canvas', {width: Math.round(width * dotsPerPixel), height: Math.round(height * dotsPerPixel)});
      const context = canvas.getContext('2d');
      context.scale(dotsPerPixel, dotsPerPixel);
      return new CanvasPen(context);
    }).context.canvas.toDataURL('image/png');
  }

  get caption() { return this.section.querySelector('.caption')?.textContent ?? ''; }

  get description() { return [this.caption, `${this.drawn.alternative}.`].filter((words) => words).join(' '); }

  get fileName() {
    const words = this.item.title.toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/^-|-$/g, '').slice(0, 60);
    const number = this.report.figures.indexOf(this) + 1;
    return `${number ? `${String(number).padStart(2, '0')}-` : ''}${words || this.item.kind}`;
  }

  save(kind) {
    const address = kind === 'png' ? this.png() : `data:image/svg+xml;charset=utf-8,${encodeURIComponent(this.svg())}`;
    make('a', {href: address, download: `${this.fileName}.${kind}`}).click();
  }
}

// Pointing at a sample in one picture shows it in all.
function followPointer(panel, report) {
  const {picture, canvas} = panel;
  const tell = (event) => {
    const {left, top} = canvas.getBoundingClientRect();
    report.point(panel.nearest(event.clientX - left, event.clientY - top));
  };
  picture.addEventListener('pointermove', tell);
  picture.addEventListener('pointerdown', tell);
  picture.addEventListener('pointerleave', () => report.point(undefined));
}

// In a time panel the reader selects a range by dragging along it, and enlarges the vertical axis by dragging
// up or down; the wheel with Ctrl, or two keys, zoom at the pointer.
class TimeSelector {
  constructor(panel, report) {
    Object.assign(this, {panel, report});
    const {picture, canvas} = panel;
    this.mark = make('div', {class: 'mark', hidden: ''});
    picture.append(this.mark);
    canvas.tabIndex = 0;
    canvas.setAttribute('aria-description', 'Plus and minus zoom, arrows to the sides move, with Shift the cursor from ' +
      'sample to sample; Shift and arrows up and down enlarge and reduce; Escape shows all');
    picture.addEventListener('pointerdown', (event) => this.begin(event));
    picture.addEventListener('pointermove', (event) => this.move(event));
    picture.addEventListener('pointerup', () => this.end());
    picture.addEventListener('pointercancel', () => this.leave());
    picture.addEventListener('pointerleave', () => this.leave());
    picture.addEventListener('dblclick', () => report.clear());
    picture.addEventListener('wheel', (event) => this.wheel(event), {passive: false});
    canvas.addEventListener('keydown', (event) => this.key(event));
    canvas.addEventListener('blur', () => report.point(undefined));
  }

  get samples() { return this.report.samples; }

  // Pointer: pixels in the plot, and the position on the time axis.
  at(event) {
    const {plot} = this.panel.drawn;
    const [from, to] = this.samples.view;
    const {left, top} = this.panel.canvas.getBoundingClientRect();
    const x = Math.min(Math.max(event.clientX - left, plot.x), plot.x + plot.width);
    const y = Math.min(Math.max(event.clientY - top, plot.y), plot.y + plot.height);
    return {x, y, position: from + (x - plot.x) / plot.width * (to - from)};
  }

  begin(event) {
    if (event.button !== 0) return;
    this.from = this.to = this.at(event);
    if (event.isTrusted) this.panel.picture.setPointerCapture(event.pointerId);  // otherwise there is no pointer
  }

  // Whether the reader drags up or down rather than along.
  get isVertical() {
    return this.panel.drawn.up &&
      Math.abs(this.to.y - this.from.y) > Math.max(2 * Math.abs(this.to.x - this.from.x), 12);
  }

  move(event) {
    const now = this.at(event);
    this.report.point(this.samples.nearest(now.position));
    if (!this.from) return;
    this.to = now;
    const {plot} = this.panel.drawn;
    const {from, to} = this;
    const box = this.isVertical
      ? {left: plot.x, width: plot.width, top: Math.min(from.y, to.y), height: Math.abs(to.y - from.y)}
      : {left: Math.min(from.x, to.x), width: Math.abs(to.x - from.x), top: plot.y, height: plot.height};
    this.mark.hidden = false;
    for (const [name, pixels] of Object.entries(box)) this.mark.style[name] = `${pixels}px`;
  }

  end() {
    if (!this.from) return;
    const {from, to, isVertical} = this;
    this.leave();
    const [begin, end] = this.samples.view;
    if (isVertical) {
      const [low, high] = [from.y, to.y].map(this.panel.drawn.up).sort((a, b) => a - b);
      this.enlarge(low, high);
    } else if (Math.abs(to.position - from.position) > 0.004 * (end - begin)) {
      this.report.choose([from.position, to.position].sort((a, b) => a - b), this.samples.names);
    }
  }

  // Shows the vertical axis between two values.
  enlarge(from, to) {
    if (!isRange([from, to])) return;
    this.panel.item.vertical = {from, to, beyond: 0};
    this.panel.changed();
  }

  leave() {
    this.from = this.to = undefined;
    this.mark.hidden = true;
    this.report.point(undefined);
  }

  // Changes the visible fraction of the view around a position; the full range removes the limits.
  zoom(factor, position, lasting = true) {
    const [from, to] = this.samples.view;
    this.show(position - factor * (position - from), factor * (to - from), lasting);
  }

  // At least a few samples.
  show(begin, wanted, lasting = true) {
    const most = this.samples.length;
    const length = Math.max(wanted, Math.min(5 * most / this.samples.count, most));
    const start = Math.min(Math.max(begin, 0), most - length);
    this.report.choose(length >= most ? null : [start, start + length], this.samples.names, lasting);
  }

  // A turn of the wheel alone scrolls the page. A turn of many notches is one undo step.
  wheel(event) {
    if (!event.ctrlKey) return;
    event.preventDefault();
    this.zoom(event.deltaY < 0 ? 0.8 : 1.25, this.at(event).position, false);
    clearTimeout(this.turning);
    this.turning = setTimeout(() => this.report.remember(), 300);
  }

  key(event) {
    const {samples, report} = this;
    const [from, to] = samples.view, length = to - from;
    const turn = {ArrowUp: 0.25, ArrowDown: 1}[event.key];  // fraction of the vertical axis, to both sides of
                                                            // its middle
    const step = event.key === 'ArrowLeft' ? -1 : event.key === 'ArrowRight' ? 1 : 0;
    if (event.key === 'Escape') report.clear();
    else if (event.key === '+') this.zoom(0.5, (from + to) / 2);
    else if (event.key === '-') this.zoom(2, (from + to) / 2);
    else if (turn && event.shiftKey && this.panel.drawn.up) {
      const {plot, up} = this.panel.drawn;
      const low = up(plot.y + plot.height), high = up(plot.y), middle = (low + high) / 2;
      this.enlarge(middle - turn * (high - low), middle + turn * (high - low));
    } else if (step && event.shiftKey) {
      const start = report.cursor ?? samples.nearest((from + to) / 2);
      report.point(Math.min(Math.max(start + step, 0), samples.count - 1));
      report.tell(`${this.panel.item.title}: ${this.panel.readout.textContent}`);
    } else if (step) this.show(from + step * length / 4, length);
    else return;
    event.preventDefault();
  }
}

// Samples, bias and rms of the selection for each name of intervals.
class Regimes {
  constructor(item, section, report) {
    Object.assign(this, {item, report});
    this.table = make('table', {class: 'regime-table list-if-narrow'});
    section.querySelector('h2').after(scrolling(item.title, this.table));
  }

  draw() {
    const {samples} = this.report;
    const columns = columnsOf(samples, this.item.columns);
    const first = make('tr', {}, make('th', {rowspan: 2, scope: 'col'}, 'Regime'),
      make('th', {rowspan: 2, scope: 'col', class: 'number'}, 'Samples'),
      ...columns.map(({label}) => make('th', {colspan: 2, scope: 'colgroup', class: 'group'}, label)));
    const second = make('tr', {}, ...columns.flatMap(() =>
      ['Bias', 'Rms'].map((words) => make('th', {scope: 'col', class: 'number'}, words))));
    const headers = ['Samples', ...columns.flatMap(({label}) => [`${label}: bias`, `${label}: rms`])];
    const rows = samples.selectedByRegime.map(([name, mask]) => {
      const all = columns.map((column) => statistics(column.values, samples.indices([column], mask)));
      const step = this.step(all);
      const cells = [countText(countOf(mask)), ...all.flatMap(({mean, rms}) => [number(mean, step), number(rms, step)])];
      return make('tr', {}, make('th', {scope: 'row'}, name),
        ...cells.map((words, i) => make('td', {'class': 'number', 'data-header': headers[i]}, words)));
    });
    this.table.replaceChildren(make('thead', {}, first, second), make('tbody', {}, ...rows));
  }

  // Common number of decimals of a row: three digits of its minimum rms.
  step(all) {
    const least = Math.min(...all.map(({rms}) => rms).filter((rms) => rms > 0));
    return Number.isFinite(least) ? 10 ** Math.min(Math.floor(Math.log10(least)) - 2, 0) : 1;
  }
}

// Description of the selection, and buttons for the names of intervals.
class SelectionBar {
  constructor(report) {
    this.report = report;
    this.words = make('span', {role: 'status', class: 'selected'});
    this.hint = make('span', {class: 'hint'}, 'Drag along a picture over time to select, up or down to enlarge it; Ctrl and the wheel zoom');
    this.clear = make('button', {type: 'button', class: 'clear', onclick: () => report.clear()}, 'Show all');
    this.undo = make('button', {type: 'button', title: 'Restore the previous view', onclick: () => history.back()}, 'Undo');
    this.chips = [...report.samples.regimes.keys()].map((name) => make('button', {
      'type': 'button', 'class': 'chip', 'aria-pressed': 'false', 'onclick': () => this.toggle(name),
    }, make('span', {class: 'swatch'}), name));
    this.element = make('div', {class: 'selection', role: 'region', 'aria-label': 'Selected samples'},
      this.words, this.clear, this.undo, this.hint, make('span', {class: 'chips'}, ...this.chips));
  }

  toggle(name) {
    const {samples} = this.report;
    const names = new Set(samples.names);
    if (!names.delete(name)) names.add(name);
    this.report.choose(samples.range, names);
  }

  draw() {
    const {samples, theme} = this.report;
    const [from, to] = samples.view.map((position) => samples.at(position));
    const begin = samples.flights.length > 1 ? `${from.flight.name} ` : '';
    const end = from.flight === to.flight ? '' : `${to.flight.name} `;
    const where = samples.range ? `${begin}${clock(from.time)} – ${end}${clock(to.time)} UTC · ` : '';
    this.words.textContent = samples.isFiltered
      ? `${where}${countText(samples.selectedCount)} of ${plural(samples.count, 'sample')}`
      : `All ${plural(samples.count, 'sample')}`;
    if (!samples.selectedCount && samples.names.size)
      this.words.textContent += `: ${[...samples.names].join(' or ')} has no samples in this time range`;
    this.clear.hidden = !samples.isFiltered && !this.report.panels.some((panel) => panel.isChanged);
    this.undo.hidden = this.report.steps === 0;
    this.hint.hidden = samples.isFiltered || !this.report.panels.some(({item}) => item.kind === 'time');
    this.chips.forEach((chip, i) => {
      const names = [...samples.regimes.keys()];
      chip.setAttribute('aria-pressed', String(samples.names.has(names[i])));
      const {colour, dash} = regimeMark(names[i], names, theme);
      chip.querySelector('.swatch').style.background =
        dash ? `repeating-linear-gradient(90deg, ${colour} 0 ${dash[0] / 2}px, transparent 0 ${(dash[0] + dash[1]) / 2}px)` : colour;
    });
  }
}
