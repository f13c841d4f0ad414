// Starts the page. `window.pcorReport` is the report for other scripts and for the tests.
//
// Words after # in the address: "light" and "dark" choose the colours, "selftest" has the page test itself,
// "export" leaves only the pictures, for tools/report_pictures.

class ReportPage {
  constructor(data) {
    this.ready = false;
    this.errors = [];
    window.addEventListener('error', ({message}) => this.errors.push(message));
    window.addEventListener('unhandledrejection', ({reason}) => this.errors.push(String(reason)));
    this.printing = false;
    this.darkMedia = window.matchMedia('(prefers-color-scheme: dark)');
    this.samples = new Samples(data);
    this.panels = [];
    this.tables = [];
    data.items.forEach((item, i) => {
      const section = document.querySelector(`[data-item="${i}"]`);
      if (item.kind === 'regimes') this.tables.push(new Regimes(item, section, this));
      else if (pictures[item.kind]) this.panels.push(new Panel(item, section, this));
    });
    for (const panel of this.panels) if (panel.item.kind === 'time') new TimeSelector(panel, this);
    this.bar = new SelectionBar(this);
    if (this.samples.count) document.querySelector('main').before(this.bar.element);
    this.addThemeButton();
    this.draw();
    this.watch();
    this.firstFrame = performance.now();  // ms after the page began to load
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
      this.draw();
    };
    window.addEventListener('beforeprint', () => print(true));
    window.addEventListener('afterprint', () => print(false));
  }

  draw() {
    for (const part of [...this.panels, ...this.tables]) part.draw();
    if (this.samples.count) this.bar.draw();
  }

  choose(range, names) {
    this.samples.choose(range, names);
    this.draw();
  }

  // Selects the samples from t0 to t1, both in seconds since 1970 UTC.
  select(t0, t1) {
    this.samples.select(t0, t1);
    this.draw();
  }

  clear() { this.choose(null); }

  get points() { return this.panels.map((panel) => panel.drawn.points); }

  get selection() {
    const {range, names, selectedCount} = this.samples;
    const [from, to] = (range ?? []).map((position) => this.samples.at(position).time);
    return {from, to, names: [...names], count: selectedCount};
  }

  // The picture of a panel, counted from 0, as the text of an SVG file.
  svg(panel) { return this.panels[panel].svg(); }

  // Every picture as a line "NAME BASE64".
  exportText() {
    const letters = (bytes) => bytes.reduce((text, byte) => text + String.fromCharCode(byte), '');
    const base64 = (text) => btoa(letters(new TextEncoder().encode(text)));
    return this.panels.flatMap((panel) => [
      `${panel.fileName}.svg ${base64(panel.svg())}`,
      `${panel.fileName}.png ${panel.png().split(',')[1]}`,
    ]).join('\n');
  }
}

const wishes = location.hash.slice(1).split('+');
for (const theme of ['light', 'dark']) if (wishes.includes(theme)) document.documentElement.dataset.theme = theme;
window.pcorReport = new ReportPage(JSON.parse(document.getElementById('data').textContent));
const leave = (id, text) => make('pre', {id}, text);
if (wishes.includes('selftest')) document.body.append(leave('selftest', JSON.stringify(selfTest(window.pcorReport))));
if (wishes.includes('export')) document.body.replaceChildren(leave('export', `\n${window.pcorReport.exportText()}\n`));
