// Starts the page. `window.pcorReport` is the report for the tests.
//
// Words after # in the address: "light" and "dark" choose the colours, "export" keeps only the pictures, for
// tools/pcor-figures, and "for=slide" sets their purpose (see `uses`).

const wishes = location.hash.slice(1).split('+');

class ReportPage {
  constructor(data) {
    this.ready = false;
    this.printing = false;
    // Purpose of saved pictures.
    this.use = Object.keys(uses).find((use) => wishes.includes(`for=${use}`)) ?? 'page';
    this.steps = 0;  // number of steps that can be undone
    this.darkMedia = window.matchMedia('(prefers-color-scheme: dark)');
    this.samples = new Samples(data);
    this.panels = [];
    this.tables = [];
    data.items.forEach((item, i) => {
      const section = document.querySelector(`[data-item="${i}"]`);
      if (item.kind === 'regimes') this.tables.push(new Regimes(item, section, this));
      else if (item.kind === 'what-if') this.whatIf = new WhatIf(item, section, this);
      else if (pictures[item.kind]) this.panels.push(new Panel(item, section, this));
    });
    for (const panel of this.panels) {
      if (overTime(panel.item)) new TimeSelector(panel, this);
      else if (['binned', 'plane', 'pair', 'track'].includes(panel.item.kind)) followPointer(panel, this);
    }
    this.bar = new SelectionBar(this);
    if (this.samples.count) document.querySelector('main').before(this.bar.element);
    this.addThemeButton();
    this.spoken = make('p', {'class': 'spoken', 'aria-live': 'polite'});
    document.body.append(this.spoken);
    this.addGuide();
    this.recall();
    this.watch();
    this.ready = true;
  }

  get isDark() {
    const {theme} = document.documentElement.dataset;
    return !this.printing && (theme ? theme === 'dark' : this.darkMedia.matches);
  }

  get theme() { return this.isDark ? palettes.dark : palettes.light; }

  get sharpness() { return this.printing ? 3 : Math.max(window.devicePixelRatio || 1, 1); }

  addThemeButton() {
    const words = () => this.isDark ? 'Light colours' : 'Dark colours';
    const button = make('button', {type: 'button', class: 'theme', title: 'Change the colours of the page', onclick: () => {
      document.documentElement.dataset.theme = this.isDark ? 'light' : 'dark';
      button.textContent = words();
      this.draw();
    }}, words());
    document.querySelector('header').append(button);
  }

  watch() {
    let asked = false;
    const later = () => {
      if (asked) return;
      asked = true;
      requestAnimationFrame(() => {
        asked = false;
        this.draw();
      });
    };
    new ResizeObserver(() => {
      if (!this.printing && this.panels.some((panel) => Math.round(panel.picture.clientWidth) !== panel.width)) later();
    }).observe(document.querySelector('main'));
    this.darkMedia.addEventListener('change', later);
    const print = (printing) => {
      this.printing = printing;
      if (printing) for (const fold of document.querySelectorAll('.fold')) fold.open = true;
      this.draw();
    };
    window.addEventListener('popstate', ({state}) => {
      this.steps = state?.steps ?? 0;
      this.recall();
    });
    window.addEventListener('beforeprint', () => print(true));
    window.addEventListener('afterprint', () => print(false));
  }

  draw() {
    for (const part of [...this.panels, ...this.tables]) part.draw();
    if (this.samples.count) this.bar.draw();
  }

  // Shows a sample in every picture; undefined for no sample.
  point(i) {
    this.cursor = i;
    for (const panel of this.panels) panel.point(i);
  }

  // Announces changes of pictures to screen readers.
  tell(words) { this.spoken.textContent = words; }

  choose(range, names, lasting = true) {
    this.samples.choose(range, names);
    this.draw();
    if (lasting) this.remember();
  }

  // Stores the state in the address: it can be sent to a colleague, and the back button of the browser works.
  remember() {
    const view = {};
    const {range, names} = this.samples;
    if (range) view.range = range.map((position) => Math.round(1000 * position) / 1000);
    if (names.size) view.names = [...names];
    this.panels.forEach(({item: {choice, hidden, vertical}}, i) => {
      const own = {};
      if (choice && choice !== this.panels[i].item.x_choices[0]) own.choice = choice;
      if (hidden?.size) own.hidden = [...hidden];
      if (vertical) own.vertical = [vertical.from, vertical.to];
      if (Object.keys(own).length) (view.panels ??= {})[i] = own;
    });
    if (this.whatIf?.state) view.whatIf = this.whatIf.state;
    const words = Object.keys(view).length ? [`view=${encodeURIComponent(JSON.stringify(view))}`] : [];
    const address = `#${[...wishes.filter((wish) => !wish.startsWith('view=')), ...words].join('+')}`;
    if (address === (location.hash || '#')) return;
    try {
      history.pushState({steps: this.steps + 1}, '', address);
      if ((location.hash || '#') === address) ++this.steps;
    } catch (error) {
      // A browser limits the rate of such steps; the page itself is still updated.
      if (error.name !== 'SecurityError') throw error;
    }
    if (this.samples.count) this.bar.draw();
  }

  // Restores the state from the address; parts of other reports are ignored.
  recall() {
    const {samples} = this;
    let view = {};
    try {
      const word = location.hash.slice(1).split('+').find((each) => each.startsWith('view=')) ?? '';
      view = JSON.parse(decodeURIComponent(word.slice(5)) || '{}') ?? {};
    } catch (error) {
      if (!(error instanceof SyntaxError || error instanceof URIError)) throw error;
    }
    const range = Array.isArray(view.range) ? view.range.map((at) => Math.min(Math.max(at, 0), samples.length)) : null;
    const names = (Array.isArray(view.names) ? view.names : []).filter((name) => samples.regimes.has(name));
    samples.choose(isRange(range) ? range : null, new Set(names));
    this.panels.forEach((panel, i) => {
      const {item, select} = panel;
      const {choice, hidden, vertical} = view.panels?.[i] ?? {};
      if (select) select.value = item.choice = item.x_choices.includes(choice) ? choice : item.x_choices[0];
      if (item.hidden) {
        const off = item.columns.filter((name) => Array.isArray(hidden) && hidden.includes(name));
        item.hidden = new Set(off.length < item.columns.length ? off : []);
      }
      item.vertical = isRange(vertical) ? {from: vertical[0], to: vertical[1], beyond: 0} : undefined;
    });
    this.whatIf?.recall(view.whatIf);
    this.draw();
  }

  // Table of contents of a long page, and the purpose of saved pictures.
  addGuide() {
    const select = make('select', {onchange: () => { this.use = select.value; }},
      ...Object.entries(uses).map(([value, {words}]) => make('option', {value}, words)));
    select.value = this.use;
    const guide = make('section', {'class': 'guide', 'aria-label': 'The pictures'}, make('label', {class: 'use'}, 'Pictures are saved for ', select));
    if (this.panels.length) document.querySelector('main').before(guide);
    const titles = [...document.querySelectorAll('.item > h2')];
    if (titles.length < 6) return;
    const list = titles.map((title) => make('li', {}, make('a', {href: '#', onclick: (event) => {
      event.preventDefault();
      title.tabIndex = -1;
      title.focus({preventScroll: true});
      title.scrollIntoView({block: 'start'});
    }}, title.textContent)));
    guide.prepend(make('nav', {'aria-label': 'Contents'},
      make('details', {}, make('summary', {}, `Contents: ${titles.length} parts`), make('ol', {}, ...list))));
    document.querySelector('main').before(guide);
  }

  clear() {
    for (const panel of this.panels) panel.reset();
    this.choose(null);
  }

  get points() { return this.panels.map((panel) => panel.drawn.points); }

  get selection() {
    const {range, names, selectedCount} = this.samples;
    const [from, to] = (range ?? []).map((position) => this.samples.at(position).time);
    return {from, to, names: [...names], count: selectedCount};
  }

  // Pictures that do not depend on interactive changes.
  get figures() { return this.panels.filter(({item}) => !item.isLive); }

  // Provenance of the report, for pictures without the page.
  get origin() {
    return [...document.querySelectorAll('footer div')].map((fact) =>
      `${fact.querySelector('dt').textContent}: ${fact.querySelector('dd').textContent}.`).join(' ');
  }

  // All figures, their captions and the provenance, as lines "NAME BASE64".
  exportText() {
    const letters = (bytes) => bytes.reduce((text, byte) => text + String.fromCharCode(byte), '');
    const base64 = (text) => btoa(letters(new TextEncoder().encode(text)));
    const pictures = this.figures.flatMap((panel) => [
      `${panel.fileName}.svg ${base64(panel.svg())}`,
      `${panel.fileName}.png ${panel.png().split(',')[1]}`,
    ]);
    const captions = this.figures.map((panel) => `${panel.fileName}: ${panel.item.title}. ${panel.description}\n`);
    if (!captions.length) captions.push('This report has no pictures.\n');
    if (this.origin) captions.push(`${this.origin}\n`);
    return [...pictures, `captions.txt ${base64(captions.join('\n'))}`].join('\n');
  }
}

for (const theme of ['light', 'dark']) if (wishes.includes(theme)) document.documentElement.dataset.theme = theme;
window.pcorReport = new ReportPage(JSON.parse(document.getElementById('data').textContent));
if (wishes.includes('export'))
  document.body.replaceChildren(make('pre', {id: 'export'}, `\n${window.pcorReport.exportText()}\n`));
