// Effects that the reader switches on, with their coefficients on sliders; residual, table, steps and figures
// follow.

const sliderSteps = 1000;

const heldOutWords = 'rms, held out';

const notFound = 'not found';  // `why` of effects that the search did not find

// Value for a number box: four digits, small values with an exponent, so that nine characters suffice.
function boxText(value) {
  const rounded = Number(value.toPrecision(4));
  return rounded !== 0 && Math.abs(rounded) < 1e-3 ? rounded.toExponential() : String(rounded);
}

class WhatIf {
  constructor(item, section, report) {
    Object.assign(this, {item, section, report});
    this.fit = new WhatIfFit(item);
    this.forget();
    this.readColumns();
    this.makeControls();
    this.makePictures();
    const body = make('div', {class: 'what-if-body'}, this.controls, this.pictures);
    section.querySelector('.caption').after(body);
    this.update();
  }

  // Restores the initial state.
  forget() {
    this.on = new Set();
    this.byHand = new Map();
    this.own = true;
    this.pair = [0, Math.min(1, this.item.effects.length - 1)];
  }

  get samples() { return this.report.samples; }

  get isChanged() { return this.on.size > 0 || !this.own; }

  // Columns at some samples, and the position of each sample of the report between them.
  readColumns() {
    const {item, samples} = this;
    const points = unpacked(item.points);
    this.columns = item.columns.map((column) => decodeColumn({...column, name: '', title: '', unit: ''}).values);
    this.before = new Int32Array(samples.count).fill(-1);
    this.part = new Float64Array(samples.count);
    this.points = points.length;
    for (const {first, end} of samples.flights) {
      let k = points.findIndex((i) => i >= first);
      if (k < 0 || points[k] >= end) continue;
      for (let i = first; i < end; ++i) {
        while (k + 1 < points.length && points[k + 1] < end && points[k + 1] <= i) ++k;
        const next = k + 1 < points.length && points[k + 1] < end ? k + 1 : k;
        const from = samples.position[points[k]], to = samples.position[points[next]];
        this.before[i] = k;
        this.part[i] = to > from ? Math.min(Math.max((samples.position[i] - from) / (to - from), 0), 1) : 0;
      }
    }
    this.residual = samples.columns.get(item.residual);
    this.again = this.addColumn('what-if-again', 'residual, fit on this page', false);
    this.live = this.addColumn('what-if', 'residual, what if', true);
    this.sides = ['what-if-first', 'what-if-second'].map((name) => this.addColumn(name, name, false));
  }

  addColumn(name, title, live) {
    const column = {name, title, label: `${title} (hPa)`, unit: 'hPa', live, values: new Float64Array(this.samples.count).fill(NaN)};
    this.samples.columns.set(name, column);
    return column;
  }

  // Fills `result` with the change of the residual by changes of the coefficients.
  takenOff(values, result) {
    const sums = new Float64Array(this.points + 1);
    this.columns.forEach((column, c) => {
      if (values[c]) for (let k = 0; k < this.points; ++k) sums[k] += values[c] * column[k];
    });
    sums[this.points] = sums[this.points - 1];
    for (let i = 0; i < result.length; ++i) {
      const k = this.before[i];
      result[i] = k < 0 ? NaN : sums[k] + this.part[i] * (sums[k + 1] - sums[k]);
    }
  }

  makeControls() {
    const {item} = this;
    const text = (words, attributes = {}) => make('span', attributes, words);
    this.figures = make('table', {'aria-label': 'Figures'});
    this.ownSwitch = make('input', {type: 'checkbox', role: 'switch', onchange: () => {
      this.own = this.ownSwitch.checked;
      this.changed();
    }});
    this.reset = make('button', {type: 'button', onclick: () => {
      this.forget();
      this.changed();
    }}, 'Reset');
    this.rows = item.effects.map((effect, e) => this.effectRow(effect, e));
    this.command = make('code');
    this.copy = make('button', {type: 'button', onclick: () => this.copyCommand()}, 'Copy');
    this.commandPart = make('div', {class: 'what-if-command'}, make('p', {}, 'To add the active effects, and refit'), this.copy, this.command);
    this.coefficients = make('table');
    this.controls = make('div', {class: 'what-if-controls'},
      scrolling('Residual by fit', this.figures),
      make('div', {class: 'what-if-general'},
        make('label', {class: 'switch'}, this.ownSwitch, text('The model’s coefficients are fitted again')), this.reset),
      this.commandPart,
      ...this.effectLists(),
      make('details', {}, make('summary', {}, 'Coefficients'), scrolling('Coefficients', this.coefficients)));
  }

  // Lists of the effects; those that the search did not find are apart.
  effectLists() {
    const list = (label, isNotFound) => {
      const shown = this.rows.filter((row, e) => (this.item.effects[e].why === notFound) === isNotFound);
      return shown.length ? [make('ul', {'class': 'what-if-effects', 'aria-label': label}, ...shown.map(({element}) => element))] : [];
    };
    const others = list('Effects that were not found', true);
    if (others.length) others.unshift(make('p', {}, 'Not found by the search. The closest ones, to try:'));
    return [...list('Effects', false), ...others];
  }

  effectRow({id, title, why, note}, e) {
    const box = make('input', {type: 'checkbox', role: 'switch', onchange: () => {
      if (box.checked) this.on.add(e);
      else this.off(e);
      this.changed();
    }});
    const gain = make('span', {class: 'gain'});
    const sliders = this.fit.coefficientsOf(e).map((c) => this.slider(c, e));
    const about = [title, note].filter((words) => words).join('. ');
    const element = make('li', {},
      make('label', {class: 'switch'}, box, make('b', {}, id), make('span', {class: 'why'}, why === notFound ? '' : why)), gain,
      make('p', {class: 'about'}, about), ...sliders.map((slider) => slider.element));
    return {element, box, gain, sliders};
  }

  off(e) {
    this.on.delete(e);
    for (const c of this.fit.coefficientsOf(e)) this.byHand.delete(c);
  }

  // Slider and number for coefficient `c` of effect `e`; their range stays fixed.
  slider(c, e) {
    const {name, unit, given, start, minimum, maximum} = this.item.coefficients[c];
    const {values, errors} = this.fit.fit([e], new Map(), true, this.fit.weightsOf([e]), false);
    const estimate = start + values[c], reach = 0.75 * Math.max(Math.abs(values[c]), 4 * errors[c]);
    const from = Math.max(Math.min(given, estimate) - reach, minimum ?? -Infinity);
    const to = Math.min(Math.max(given, estimate) + reach, maximum ?? Infinity);
    const step = 10 ** Math.floor(Math.log10(Math.max((to - from) / sliderSteps, 1e-300)));
    const label = `${this.item.effects[e].id} ${name}`;
    const range = make('input', {type: 'range', min: 0, max: sliderSteps, step: 1, 'aria-label': label});
    const number = make('input', {type: 'number', step: 'any', 'aria-label': `${label}, value`,
                                  min: minimum ?? null, max: maximum ?? null});
    const band = make('span', {class: 'band'}), zero = make('span', {class: 'zero'});
    const told = make('span', {class: 'told'});
    const fitted = make('button', {type: 'button', title: 'Fit this coefficient again', 'aria-label': `Fit ${label} again`,
                                   onclick: () => { this.byHand.delete(c); this.changed(); }}, 'Fit');
    const move = (value) => {
      this.on.add(e);
      this.byHand.set(c, value);
      this.follow();
    };
    range.addEventListener('input', () => move(from + Number(range.value) / sliderSteps * (to - from)));
    number.addEventListener('input', () => { if (number.value !== '' && number.validity.valid) move(number.valueAsNumber); });
    for (const input of [range, number]) input.addEventListener('change', () => this.changed());
    zero.style.left = this.place(given, from, to);
    const element = make('div', {class: 'coefficient'},
      make('div', {class: 'words-of'}, make('span', {class: 'name'}, name), told, fitted),
      make('span', {class: 'slider-track'}, band, zero, range), number, make('span', {class: 'unit'}, unit));
    return {c, element, range, number, band, told, fitted, from, to, step, unit};
  }

  effectOf(c) { return this.item.effects.find(({first, count}) => c >= first && c < first + count); }

  // Position of a value on a track: the thumb is 1rem wide, and its middle is the value.
  place(value, from, to) {
    const part = Math.min(Math.max((value - from) / (to - from), 0), 1);
    return `calc(0.5rem + ${part} * (100% - 1rem))`;
  }

  makePictures() {
    const {item, report} = this;
    this.pictures = make('div', {class: 'what-if-pictures'});
    const part = (kind, title, caption, ...more) => {
      const id = `what-if-${this.pictures.childElementCount}`;
      const section = make('section', {class: `item ${kind}`, 'aria-labelledby': id}, make('h2', {id}, title),
        ...more, make('p', {class: 'caption'}, caption));
      this.pictures.append(section);
      return section;
    };
    const columns = [this.again.name, this.live.name];
    const add = (own, caption, ...more) => {
      own.isLive = true;
      const panel = new Panel(own, part(own.kind, own.title, caption, ...more), report);
      report.panels.push(panel);
      return panel;
    };
    this.panels = [add({kind: 'time', title: 'What if: residual in time', columns, axis: 'residual'},
      'The scale is fixed by the residual without the effects.')];
    this.steps = {kind: 'bars', title: 'What if: steps', bars: this.stepBars(), axis: heldOutWords, unit: 'hPa'};
    this.panels.push(add(this.steps, `Effects in the order in which they were switched on. ${this.fit.heldOut
      ? 'Held out: flights or parts that no fit includes.'
      : 'Held out: five-fold cross-validation of the fit on this page, in blocks of 5 min, without outliers.'}`));
    const regimes = {title: 'Bias and rms by regime, what if', columns};
    this.regimes = new Regimes(regimes, part('regimes', 'What if: by regime', 'Bias and rms of the residual of the selected samples.'), report);
    report.tables.push(this.regimes);
    if (item.x_choices.length)
      this.panels.push(add({kind: 'binned', title: 'What if: residual against a variable', columns, x_choices: item.x_choices,
        autocorrelation_time: item.autocorrelation_time, axis: 'residual'}, 'A slope or curvature larger than the error bars indicates a missing effect or slow drift.'));
    if (item.effects.length > 1) this.makePair(add, part);
  }

  makePair(add, part) {
    const {item} = this;
    this.selects = [0, 1].map((side) => {
      const select = make('select', {onchange: () => {
        this.pair[side] = Number(select.value);
        this.changed();
      }}, ...item.effects.map(({id}, e) => make('option', {value: e}, id)));
      return select;
    });
    const labels = ['One', 'The other'].map((words, side) => make('label', {class: 'choice'}, words, this.selects[side]));
    this.pairWords = make('p', {class: 'what-if-words'});
    this.pairTable = make('table', {class: 'regime-table'});
    this.pairPanel = add({kind: 'time', title: 'Two effects side by side', columns: this.sides.map(({name}) => name), axis: 'change of the residual'},
      'Reduction of the residual by each effect alone, with the model fitted again: where the two curves differ, these flights distinguish the effects.',
      make('div', {class: 'what-if-pair'}, ...labels));
    this.panels.push(this.pairPanel);
    part('table', 'Where the two differ', 'Rms of the reduction of the residual by each effect, and of the difference, over the selected samples; the correlation covers the same samples, the sentence all samples.',
      this.pairWords, scrolling('Two effects by regime', this.pairTable));
    this.report.tables.push({draw: () => this.fillPairTable(), table: this.pairTable});
  }

  // Steps: with the initial coefficients, with the model's coefficients fitted, and with one effect after
  // another.
  stepBars() {
    const {fit, item} = this;
    const bars = [{label: item.start, value: this.heldOutRms(fit.fit([], new Map(), false), false)}];
    const on = [...this.on];
    for (let count = this.own ? 0 : 1; count <= on.length; ++count)
      bars.push({label: count ? `+ ${item.effects[on[count - 1]].id}` : 'fit on this page',
                 value: this.heldOutRms(fit.fit(on.slice(0, count), this.byHand, this.own), this.own)});
    bars.push({label: item.noiseLabel, value: item.noise});
    return bars.filter(({value}) => Number.isFinite(value));
  }

  // Unknown with initial coefficients that were fitted to the same samples. @param own they are fitted again
  heldOutRms(fitted, own) { return own || !this.item.isStartFitted ? this.fit.heldOutRms(fitted) : NaN; }

  // Call after a step that can be undone.
  changed() {
    this.follow();
    this.report.remember();
    const {rms} = this.now;
    this.report.tell(`Rms ${brief(this.nothing.rms)} hPa without, ${brief(rms)} hPa with ${this.names || 'no effect'}`);
  }

  get names() { return [...this.on].map((e) => this.item.effects[e].id).join(', '); }

  // Shows a change at the next frame; only the last of several changes in one frame.
  follow() {
    this.fitNow();
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.update();
      for (const panel of this.panels) panel.draw();
      this.regimes.draw();
      this.fillPairTable();
    });
  }

  fitNow() {
    const {fit} = this;
    this.nothing = fit.fit([]);
    this.now = fit.fit(this.on, this.byHand, this.own);
  }

  update() {
    this.fitNow();
    this.fillResidual(this.again, this.nothing);
    if (this.isChanged) this.fillResidual(this.live, this.now);
    else this.live.values.fill(NaN);
    this.steps.bars = this.stepBars();
    this.showFigures();
    this.ownSwitch.checked = this.own;
    this.reset.disabled = !this.isChanged;
    this.rows.forEach((row, e) => this.showEffect(row, e));
    this.showCoefficients();
    this.showCommand();
    this.comparePair();
  }

  // Fills a column with the residual of a fit.
  fillResidual(column, fitted) {
    const {values} = column;
    this.takenOff(fitted.values, values);
    for (let i = 0; i < values.length; ++i) values[i] = this.residual.values[i] - values[i];
  }

  // Decrease of chi2 from the refitted model to the displayed state.
  get fallOfNow() {
    return this.fit.gain(this.fit.fit([], new Map(), this.own, this.now.weights), this.now, [...this.on]);
  }

  showFigures() {
    const {fit, nothing, now, item} = this;
    const given = fit.fit([], new Map(), false);
    const row = (words, values) => [words, ...values.map((value, i) => i === 2 && !this.isChanged ? '–' : number(value, 1e-4))];
    fillTable(this.figures, {
      headers: ['hPa', item.start, 'fit on this page', 'what if'],
      rows: [row('rms', [given.rms, nothing.rms, now.rms]),
             row(heldOutWords, [this.heldOutRms(given, false), this.heldOutRms(nothing, true), this.heldOutRms(now, this.own)]),
             [item.noiseLabel, '', '', number(item.noise, 1e-4)],
             ['decrease of χ²', '', '', this.isChanged ? number(this.fallOfNow, 0.1) : '–']],
    });
  }

  showEffect({box, gain, sliders}, e) {
    const {fit} = this;
    const isOn = this.on.has(e);
    box.checked = isOn;
    const others = [...this.on].filter((other) => other !== e);
    const ifOn = isOn ? this.now : fit.fit([...others, e], this.byHand, this.own);
    const fall = fit.fall(others, [...others, e], this.byHand, this.own);
    gain.textContent = `χ² ${fall < -0.05 ? 'increases' : 'decreases'} by ${number(Math.abs(fall), Math.abs(fall) < 10 ? 0.1 : 1)}`;
    gain.title = `Decrease of chi2 ${isOn ? 'by this effect, in addition to the other active ones' : 'if this effect is added to the active ones'}; for one fitted coefficient: (change / error)²`;
    for (const slider of sliders) this.showSlider(slider, e, isOn, ifOn);
  }

  showSlider({c, range, number: input, band, told, fitted, from, to, step, unit}, e, isOn, ifOn) {
    const {start} = this.item.coefficients[c];
    const byHand = this.byHand.has(c);
    // Fitted value, with the other coefficients unchanged.
    const hand = new Map(this.byHand);
    hand.delete(c);
    const {values, errors} = byHand ? this.fit.fit([...this.on], hand, this.own) : ifOn;
    const estimate = start + values[c], error = errors[c];
    const value = byHand ? this.byHand.get(c) : estimate;
    range.value = Math.round((value - from) / (to - from) * sliderSteps);
    range.setAttribute('aria-valuetext', `${number(value, step)} ${unit === '1' ? '' : unit}`.trim());
    if (document.activeElement !== input || Number(input.value) !== value) input.value = boxText(value);
    band.hidden = !(error > 0);
    band.style.left = this.place(estimate - error, from, to);
    band.style.right = `calc(100% - ${this.place(estimate + error, from, to)})`;
    told.textContent = error > 0 ? withError(estimate, error) : this.fit.isAtBound(c, values) ? 'at its bound' : 'not identifiable';
    told.title = 'Fitted value with its standard error';
    fitted.hidden = !byHand;
  }

  showCoefficients() {
    const {item, nothing, now} = this;
    const shown = (fitted, c) => {
      const {start} = item.coefficients[c];
      return fitted.errors[c] > 0 ? withError(start + fitted.values[c], fitted.errors[c]) : brief(start + fitted.values[c]);
    };
    const rows = item.coefficients.map(({name, unit, given}, c) => ({c, name, unit, given}))
      .filter(({c}) => c < item.own || this.on.has(item.effects.indexOf(this.effectOf(c))))
      .map(({c, name, unit, given}) => [`${c < item.own ? '' : `${this.effectOf(c).id}.`}${name}`, brief(given),
                                        c < item.own ? shown(nothing, c) : '–', this.isChanged ? shown(now, c) : '–', unit]);
    fillTable(this.coefficients, {headers: ['Coefficient', 'input model', 'fit on this page', 'what if', 'unit'], rows});
  }

  // Command that adds the active effects: one for all of the catalogue, one for each formula.
  get commandText() {
    const {commands, effects, coefficients} = this.item;
    const on = [...this.on].sort((a, b) => a - b).map((e) => effects[e]).filter(({argument}) => argument);
    if (!on.length || !commands.add) return '';
    const catalogue = on.filter(({isFormula}) => !isFormula).map(({argument}) => argument).join(' ');
    const added = [...(catalogue ? [catalogue] : []), ...on.filter(({isFormula}) => isFormula).map(({argument}) => argument)];
    const stem = [commands.stem, ...on.map(({id}) => id.replace(/[^\w-]/g, '_'))].join('-');
    const name = (n) => `${stem}${n + 1 === added.length ? '' : `-${n + 1}`}.toml`;
    const lines = added.map((argument, n) =>
      `${commands.add} ${argument} -m ${n ? name(n - 1) : commands.model} ${commands.with} -o ${name(n)}`);
    const held = on.flatMap(({first, count}) => coefficients.slice(first, first + count)
      .filter(({fixed}) => fixed).map(({argument}) => ` --fix ${argument}`)).join('');
    return [...lines, `${commands.refit} -m ${name(added.length - 1)}${held} -o ${stem}-refitted.toml`].join(' && \\\n  ');
  }

  showCommand() {
    const text = this.commandText;
    this.commandPart.hidden = !this.on.size;
    this.command.textContent = text || 'No command can add this.';
    this.copy.disabled = !text;
    this.copy.textContent = 'Copy';
  }

  async copyCommand() {
    try {
      await navigator.clipboard.writeText(this.commandText);
    } catch {
      // If the browser does not allow a copy, the command is selected for the reader.
      getSelection().selectAllChildren(this.command);
      this.copy.textContent = 'Marked';
      return;
    }
    this.copy.textContent = 'Copied';
    this.report.tell('The command is copied');
  }

  comparePair() {
    if (!this.selects) return;
    const {fit, item, nothing, samples} = this;
    this.pair.forEach((e, side) => {
      this.selects[side].value = e;
      const {values} = fit.fit([e]);
      const change = values.map((value, c) => value - nothing.values[c]);
      this.takenOff(change, this.sides[side].values);
      const column = this.sides[side];
      column.title = item.effects[e].id + (this.pair[0] === this.pair[1] && side ? ' again' : '');
      column.label = `${column.title} (hPa)`;
      this.pairPanel.switches[side].lastChild.data = column.title;
    });
    const [a, b] = this.pair;
    const alike = correlationOf(...this.sides.map(({values}) => values), samples.indices(this.sides, samples.every));
    this.pairWords.textContent = a === b ? 'Choose two effects.'
      : `On these flights the two have a correlation of ${number(alike, 0.001)}, after fitting the model’s coefficients.`;
  }

  fillPairTable() {
    if (!this.selects) return;
    const {samples} = this;
    const [a, b] = this.sides;
    const difference = a.values.map((value, i) => value - b.values[i]);
    const rows = samples.selectedByRegime.map(([name, mask]) => {
      const inside = samples.indices([a, b], mask);
      const rms = (values) => statistics(values, inside).rms;
      return [name, countText(inside.length), ...[a.values, b.values, difference].map((values) => number(rms(values), 0.001)),
              number(correlationOf(a.values, b.values, inside), 0.001)];
    });
    fillTable(this.pairTable, {headers: ['Regime', 'Samples', `${a.title}, hPa`, `${b.title}, hPa`, 'Difference, hPa', 'Correlation'], rows});
  }

  // State in the address, and its restoration; parts of other reports are ignored.
  get state() {
    const {item} = this;
    const state = {};
    const name = (c) => `${this.effectOf(c).id}.${item.coefficients[c].name}`;
    if (this.on.size) state.on = [...this.on].map((e) => item.effects[e].id);
    if (this.byHand.size) state.by = Object.fromEntries([...this.byHand].map(([c, value]) => [name(c), Number(value.toPrecision(8))]));
    if (!this.own) state.own = false;
    if (this.pair[0] !== 0 || this.pair[1] !== Math.min(1, item.effects.length - 1)) state.pair = this.pair.map((e) => item.effects[e].id);
    return Object.keys(state).length ? state : undefined;
  }

  recall(state) {
    const {item} = this;
    const numberOf = (id) => item.effects.findIndex((effect) => effect.id === id);
    this.forget();
    const known = (ids) => Array.isArray(ids) ? ids.map(numberOf).filter((e) => e >= 0) : [];
    for (const e of known(state?.on)) this.on.add(e);
    for (const e of this.on)
      for (const c of this.fit.coefficientsOf(e)) {
        const value = state?.by?.[`${item.effects[e].id}.${item.coefficients[c].name}`];
        if (Number.isFinite(value)) this.byHand.set(c, this.fit.possible(c, value));
      }
    this.own = state?.own !== false;
    const pair = known(state?.pair);
    if (pair.length === 2) this.pair = pair;
    this.update();
  }
}

// Correlation of two series at some samples, -1 to 1.
function correlationOf(xs, ys, indices) {
  let sx = 0, sy = 0, xx = 0, yy = 0, xy = 0;
  for (const i of indices) {
    sx += xs[i];
    sy += ys[i];
    xx += xs[i] * xs[i];
    yy += ys[i] * ys[i];
    xy += xs[i] * ys[i];
  }
  const count = indices.length;
  return (xy - sx * sy / count) / Math.sqrt((xx - sx * sx / count) * (yy - sy * sy / count));
}
