// The panels on the page: picture, buttons, numbers in words; and what the reader selects.

function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else if (value !== null) element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

const isNumber = (words) => /^[−–\d]/.test(words);

function fillTable(table, {headers, rows}) {
  const head = make('tr', {}, ...headers.map((words, i) =>
    make('th', {scope: 'col', class: i && rows.some((row) => isNumber(row[i])) ? 'number' : null}, words)));
  const body = rows.map((row) => make('tr', {}, ...row.map((words, i) =>
    i ? make('td', {class: isNumber(words) ? 'number' : null}, words) : make('th', {scope: 'row'}, words))));
  table.replaceChildren(make('thead', {}, head), make('tbody', {}, ...body));
}

const exportSizes = {time: [760, 300], other: [560, 400]};

// Every bar has a row of its own, as long as the picture can hold them.
const heightOfBars = ({bars}) => 70 + 30 * Math.min(Math.max(bars.length, 2), 40);

class Panel {
  constructor(item, section, report) {
    Object.assign(this, {item, section, report});
    this.canvas = make('canvas', {role: 'img'});
    this.picture = make('div', {class: 'picture'}, this.canvas);
    this.numbers = make('table');
    const tools = make('div', {class: 'tools'},
      make('button', {type: 'button', title: 'Save this picture as SVG', onclick: () => this.save('svg')}, 'SVG'),
      make('button', {type: 'button', title: 'Save this picture as PNG', onclick: () => this.save('png')}, 'PNG'));
    section.querySelector('h2').after(tools, this.picture, this.choice());
    section.append(make('details', {}, make('summary', {}, 'Numbers'), make('div', {class: 'scroll'}, this.numbers)));
  }

  choice() {
    if (!(this.item.choices?.length > 1)) return '';
    const options = this.item.choices.map((name) =>
      make('option', {value: name}, this.report.samples.columns.get(name).title));
    const select = make('select', {}, ...options);
    select.addEventListener('change', () => {
      this.item.choice = select.value;
      this.draw();
    });
    return make('label', {class: 'choice'}, 'Horizontal axis', select);
  }

  get height() {
    if (this.item.kind === 'bars') return heightOfBars(this.item);
    const {screen, print} = this.item.kind === 'time' ? {screen: 280, print: 200} : {screen: 380, print: 300};
    return this.report.printing ? print : screen;
  }

  draw() {
    const {samples, theme, sharpness} = this.report;
    const width = Math.max(Math.round(this.picture.clientWidth), 280);
    this.canvas.width = width * sharpness;
    this.canvas.height = this.height * sharpness;
    this.canvas.style.aspectRatio = `${width} / ${this.height}`;
    const context = this.canvas.getContext('2d');
    context.scale(sharpness, sharpness);
    this.width = width;
    this.drawn = pictures[this.item.kind](new CanvasPen(context), width, this.height, this.item, samples, theme);
    const {alternative, points, table} = this.drawn;
    this.canvas.setAttribute('aria-label', `${this.item.title}. ${alternative}. ${plural(points, 'point')}.`);
    fillTable(this.numbers, table);
  }

  get exportSize() {
    const [width, height] = exportSizes[this.item.kind] ?? exportSizes.other;
    return [width, this.item.kind === 'bars' ? heightOfBars(this.item) : height];
  }

  // The picture on white, for a paper.
  svg() {
    const [width, height] = this.exportSize;
    const pen = new SvgPen(width, height, this.item.title);
    pictures[this.item.kind](pen, width, height, this.item, this.report.samples, palettes.light);
    return pen.svg;
  }

  png() {
    const [width, height] = this.exportSize, dotsPerPixel = 3;
    const canvas = make('canvas', {width: width * dotsPerPixel, height: height * dotsPerPixel});
    const context = canvas.getContext('2d');
    context.scale(dotsPerPixel, dotsPerPixel);
    pictures[this.item.kind](new CanvasPen(context), width, height, this.item, this.report.samples, palettes.light);
    return canvas.toDataURL('image/png');
  }

  get fileName() {
    const words = this.item.title.toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/^-|-$/g, '').slice(0, 60);
    return `${String(this.report.panels.indexOf(this) + 1).padStart(2, '0')}-${words || this.item.kind}`;
  }

  save(kind) {
    const address = kind === 'png' ? this.png() : `data:image/svg+xml;charset=utf-8,${encodeURIComponent(this.svg())}`;
    make('a', {href: address, download: `${this.fileName}.${kind}`}).click();
  }
}

// A time panel also shows what is under the pointer and selects a range: by dragging, or by + - arrows and Escape.
class TimeSelector {
  constructor(panel, report) {
    Object.assign(this, {panel, report});
    const {picture, canvas} = panel;
    this.mark = make('div', {class: 'mark', hidden: ''});
    this.readout = make('p', {class: 'readout', 'aria-hidden': 'true'});
    picture.append(this.mark);
    panel.section.querySelector('.tools').prepend(this.readout);
    canvas.tabIndex = 0;
    canvas.setAttribute('aria-description', 'Plus and minus zoom, arrows move, Escape shows all');
    picture.addEventListener('pointerdown', (event) => this.begin(event));
    picture.addEventListener('pointermove', (event) => this.move(event));
    picture.addEventListener('pointerup', () => this.end());
    picture.addEventListener('pointercancel', () => this.leave());
    picture.addEventListener('pointerleave', () => this.leave());
    picture.addEventListener('dblclick', () => report.clear());
    canvas.addEventListener('keydown', (event) => this.key(event));
  }

  position(event) {
    const {plot} = this.panel.drawn;
    const [from, to] = this.report.samples.view;
    const x = event.clientX - this.panel.canvas.getBoundingClientRect().left;
    return from + Math.min(Math.max((x - plot.x) / plot.width, 0), 1) * (to - from);
  }

  show(from, to) {
    const {plot} = this.panel.drawn;
    const [begin, end] = this.report.samples.view;
    const x = scale(begin, end, plot.x, plot.x + plot.width);
    this.mark.hidden = false;
    this.mark.style.left = `${x(Math.min(from, to))}px`;
    this.mark.style.width = `${Math.max(Math.abs(x(to) - x(from)), 1)}px`;
    this.mark.style.top = `${plot.y}px`;
    this.mark.style.height = `${plot.height}px`;
  }

  begin(event) {
    if (event.button !== 0) return;
    this.from = this.to = this.position(event);
    this.panel.picture.setPointerCapture(event.pointerId);
  }

  move(event) {
    const at = this.position(event);
    this.show(this.from ?? at, at);
    if (this.from !== undefined) this.to = at;
    this.tell(at);
  }

  end() {
    const {from, to} = this;
    this.leave();
    const [begin, end] = this.report.samples.view;
    if (from !== undefined && Math.abs(to - from) > 0.004 * (end - begin))
      this.report.choose([Math.min(from, to), Math.max(from, to)], this.report.samples.names);
  }

  leave() {
    this.from = this.to = undefined;
    this.mark.hidden = true;
    this.readout.textContent = '';
  }

  tell(at) {
    const {samples} = this.report;
    let low = 0, high = samples.count - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (samples.position[middle] < at) low = middle + 1;
      else high = middle;
    }
    const i = low > 0 && at - samples.position[low - 1] < samples.position[low] - at ? low - 1 : low;
    const values = columnsOf(samples, this.panel.item.columns)
      .map(({title, unit, values: all}) => `${title} ${brief(all[i])}${unit && !Number.isNaN(all[i]) ? ` ${unit}` : ''}`);
    this.readout.textContent = `${clock(samples.time[i])} UTC  ${values.join('  ·  ')}`;
  }

  key(event) {
    const {samples} = this.report;
    const [from, to] = samples.view, quarter = (to - from) / 4;
    const ranges = {
      '+': [from + quarter, to - quarter],
      '-': [from - 2 * quarter, to + 2 * quarter],
      'ArrowLeft': [from - quarter, to - quarter],
      'ArrowRight': [from + quarter, to + quarter],
    };
    if (event.key === 'Escape') {
      this.report.clear();
    } else if (ranges[event.key]) {
      const length = ranges[event.key][1] - ranges[event.key][0];
      if (length >= samples.length) {
        this.report.choose(null, samples.names);
      } else {
        const begin = Math.min(Math.max(ranges[event.key][0], 0), samples.length - length);
        this.report.choose([begin, begin + length], samples.names);
      }
    } else {
      return;
    }
    event.preventDefault();
  }
}

// Samples, bias and rms for each name of intervals, of what is selected.
class Regimes {
  constructor(item, section, report) {
    Object.assign(this, {item, report});
    this.table = make('table', {class: 'regime-table'});
    const scroll = {class: 'scroll', tabindex: '0', role: 'region', 'aria-label': item.title};
    section.querySelector('h2').after(make('div', scroll, this.table));
  }

  draw() {
    const {samples} = this.report;
    const columns = columnsOf(samples, this.item.columns);
    const masks = [...samples.regimes].map(([name, inside]) => [name, samples.selected.map((one, i) => one & inside[i])]);
    const first = make('tr', {}, make('th', {rowspan: 2, scope: 'col'}, 'Regime'),
      make('th', {rowspan: 2, scope: 'col', class: 'number'}, 'Samples'),
      ...columns.map(({label}) => make('th', {colspan: 2, scope: 'colgroup', class: 'group'}, label)));
    const second = make('tr', {}, ...columns.flatMap(() =>
      ['Bias', 'Rms'].map((words) => make('th', {scope: 'col', class: 'number'}, words))));
    const rows = [...masks, ['All', samples.selected]].map(([name, mask]) => {
      const all = columns.map((column) => statistics(column.values, samples.indices([column], mask)));
      const step = this.step(all);
      const cells = [countText(countOf(mask)), ...all.flatMap(({mean, rms}) => [number(mean, step), number(rms, step)])];
      return make('tr', {}, make('th', {scope: 'row'}, name),
        ...cells.map((words) => make('td', {class: 'number'}, words)));
    });
    this.table.replaceChildren(make('thead', {}, first, second), make('tbody', {}, ...rows));
  }

  // One number of decimals for a row: three digits of its least rms.
  step(all) {
    const least = Math.min(...all.map(({rms}) => rms).filter((rms) => rms > 0));
    return Number.isFinite(least) ? 10 ** Math.min(Math.floor(Math.log10(least)) - 2, 0) : 1;
  }
}

// What is selected, in words, and buttons for the names of intervals.
class SelectionBar {
  constructor(report) {
    this.report = report;
    this.words = make('span', {role: 'status', class: 'selected'});
    this.hint = make('span', {class: 'hint'}, 'Drag over a picture with a time axis to select');
    this.clear = make('button', {type: 'button', class: 'clear', onclick: () => report.clear()}, 'Show all');
    this.chips = [...report.samples.regimes.keys()].map((name) => make('button', {
      'type': 'button', 'class': 'chip', 'aria-pressed': 'false', 'onclick': () => this.toggle(name),
    }, make('span', {class: 'swatch'}), name));
    this.element = make('div', {class: 'selection', role: 'region', 'aria-label': 'Selected samples'},
      this.words, this.clear, this.hint, make('span', {class: 'chips'}, ...this.chips));
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
    this.clear.hidden = !samples.isFiltered;
    this.hint.hidden = samples.isFiltered || !this.report.panels.some(({item}) => item.kind === 'time');
    this.chips.forEach((chip, i) => {
      const name = [...samples.regimes.keys()][i];
      chip.setAttribute('aria-pressed', String(samples.names.has(name)));
      chip.querySelector('.swatch').style.background = theme.regimes[i % theme.regimes.length];
    });
  }
}
