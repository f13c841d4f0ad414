// Rows of dots with error bars: checks with their verdicts, steps of a model selection, coefficients,
// regimes.

// Marks with distinct forms, which are recognizable without colour.
const marks = [
  (pen, x, y, colour) => pen.dots([x, y], 8, colour),
  (pen, x, y, colour, paper) => {
    pen.dots([x, y], 8, colour);
    pen.dots([x, y], 4.5, paper);
  },
  (pen, x, y, colour) => pen.lines([[x - 4, y - 4, x + 4, y + 4], [x - 4, y + 4, x + 4, y - 4]], colour, 2.25),
  (pen, x, y, colour) => pen.lines([[x, y - 5, x, y + 5], [x - 5, y, x + 5, y]], colour, 2.25),
  (pen, x, y, colour) => pen.lines([[x, y - 5.5, x + 5.5, y, x, y + 5.5, x - 5.5, y, x, y - 5.5]], colour, 1.75),
];

// Appearance of a verdict: index of its colour, and its mark.
const tones = {
  good: {colour: (theme) => theme.series[0], mark: marks[0]},
  bad: {colour: (theme) => theme.series[1], mark: marks[2]},
  open: {colour: (theme) => theme.quiet, mark: marks[1]},
};

const markHeight = 17;  // height of a series in a row

function dotsHeight(rows, series) {
  return 76 + rows * Math.max(30, 8 + markHeight * series);
}

// Ends of dots with their bars; if a quarter of the rows at most would stretch the axis more than four times, they
// are beyond it.
function endsOfRows(rows, always) {
  const endsOf = (some) => some.flatMap(({dots}) => dots).filter(({value}) => Number.isFinite(value))
    .flatMap(({value, error}) => [value - error, value + error]);
  const all = endsOf(rows), middle = median(Float64Array.from(all));
  const distance = (row) => Math.max(0, ...endsOf([row]).map((end) => Math.abs(end - middle)));
  const outermost = [...rows].sort((a, b) => distance(b) - distance(a));
  const length = (ends) => Math.max(...ends, ...always) - Math.min(...ends, ...always);
  for (let beyond = 1; beyond <= rows.length / 4; ++beyond) {
    const others = endsOf(outermost.slice(beyond));
    if (others.length && length(all) > 4 * length(others)) return others;
  }
  return all;
}

// Rows {label, dots: [{value, error}, ...], text, tone, mark}: an axis below that covers `reach`, or
// otherwise the dots with their bars, a band from -1 to 1, and lines. Arrows mark dots beyond the axis.
function drawRows(pen, width, height, {rows, series, lines = [], band = '', axis, reach}, theme) {
  const colours = series.map((label, s) => theme.series[s % theme.series.length]);
  const keys = [
    ...(series.length > 1 ? series.map((label, s) => ({label, colour: colours[s], mark: marks[s % marks.length]})) : []),
    ...lines.map(([label]) => ({label, colour: theme.ink, dash: [5, 3], thickness: 1.5})),
    ...(band ? [{label: band, colour: theme.frame, wide: true}] : [])];
  const top = keys.length ? legend(pen, keys, 8, width - 14, theme) : 8;
  const swatch = rows.some(({mark}) => mark) ? 22 : 0;
  const words = Math.max(0, ...rows.map(({text}) => textWidth(text ?? '', fontSize)));
  const names = Math.max(...rows.map(({label}) => textWidth(label, fontSize))) + swatch;
  // Text is below the names if it does not fit at the right, or the names do not fit beside it.
  const below = words > 0.3 * width || (words > 0 && names + 22 > 0.36 * width);
  const longest = Math.max(names, ...rows.map(({text}) => (below ? textWidth(text ?? '', smallSize) : 0) + swatch));
  const left = Math.min(longest + 22, (below ? 0.55 : 0.36) * width);
  const right = below ? 14 : words + 20;
  const box = plotBox(width, height, {left, right, top});
  const finite = rows.flatMap(({dots}) => dots.filter(({value}) => Number.isFinite(value)));
  const always = [...lines.map(([, value]) => value), ...(band ? [-1, 1] : [])];
  const range = limits([], [...(reach ?? endsOfRows(rows, always)), ...always].filter(Number.isFinite));
  if (range.from > 0 && range.from < 0.5 * range.to) range.from = 0;
  const x = scale(range.from, range.to, box.x, box.x + box.width);
  if (band) pen.rect(x(-1), box.y, x(1) - x(-1), box.height, theme.frame, 0.22);
  horizontalAxis(pen, box, x, range, axis, theme, 52);
  const room = box.height / rows.length;
  pen.clip(box, () => {
    for (const [, value] of lines) pen.lines([[x(value), box.y, x(value), box.y + box.height]], theme.ink, 1.25, [5, 3]);
    if (range.from < 0 && range.to > 0 && !lines.some(([, value]) => value === 0)) pen.lines([[x(0), box.y, x(0), box.y + box.height]], theme.frame);
  });
  rows.forEach(({label, dots, text, tone, mark}, r) => {
    const middle = box.y + (r + 0.5) * room;
    if (r) pen.lines([[box.x, middle - room / 2, box.x + box.width, middle - room / 2]], theme.grid);
    if (mark) pen.lines([[8, middle, 24, middle]], mark.colour, 4, mark.dash ?? []);
    pen.text(box.x - 9, middle + (below && text ? -2 : 4), shortened(label, left - 18 - swatch, fontSize),
      {...small(theme, 'end'), fill: theme.ink});
    if (text && below)
      pen.text(box.x - 9, middle + 11, shortened(text, left - 18 - swatch, smallSize), {...small(theme, 'end'), size: smallSize});
    else if (text) pen.text(box.x + box.width + 9, middle + 4, text, small(theme));
    dots.forEach(({value, error}, s) => {
      if (!Number.isFinite(value)) return;
      const y = middle + (s - (dots.length - 1) / 2) * Math.min(markHeight, room / dots.length);
      const colour = tones[tone]?.colour(theme) ?? colours[s];
      const side = Math.sign(value - Math.min(Math.max(value, range.from), range.to));
      if (side) {
        const tip = side < 0 ? box.x + 2 : box.x + box.width - 2;
        pen.lines([[tip - 6 * side, y - 5, tip, y, tip - 6 * side, y + 5], [tip - 16 * side, y, tip, y]], colour, 2);
        return;
      }
      pen.clip({...box, x: box.x - 6, width: box.width + 12}, () => {
        if (error > 0) errorBar(pen, x(value - error), x(value + error), y, colour, 1.5);
        (tones[tone]?.mark ?? marks[s % marks.length])(pen, x(value), y, colour, theme.paper);
      });
    });
  });
  frame(pen, box, theme, NaN);
  return {box, points: finite.length};
}

function drawDots(pen, width, height, item, samples, theme) {
  const rows = item.rows.map(({label, dots, text, tone}) =>
    ({label, text, tone, dots: dots.map(({value, error}) => ({value: value ?? NaN, error: error ?? 0}))}));
  const axis = withUnit(item.axis, item.unit);
  const {box, points} = drawRows(pen, width, height, {...item, rows, axis}, theme);
  const toneWords = {good: 'consistent', bad: 'inconsistent', open: 'inconclusive'};
  const judged = rows.some(({tone}) => tone), told = rows.some(({text}) => text);
  return {
    points,
    plot: box,
    alternative: `${axis} of ${plural(rows.length, 'row')}: ${rows.map(({label, dots, text, tone}) =>
      `${label}${tone ? `, ${toneWords[tone]}` : ''}, ${text || dots.map(({value, error}) =>
        error ? withError(value, error) : brief(value)).join(' and ')}`).join('; ')}`,
    table: {
      headers: ['', ...item.series.map((label) => label || axis), ...(judged ? ['Verdict'] : []), ...(told ? ['Numbers'] : [])],
      rows: rows.map(({label, dots, text, tone}) => [label,
        ...dots.map(({value, error}) => error ? withError(value, error) : brief(value)),
        ...(judged ? [toneWords[tone] ?? '–'] : []), ...(told ? [text || '–'] : [])]),
    },
  };
}

const fewSamples = 60;  // a regime with fewer does not set the axis: its mean is that of a short event

// Mean of columns for each regime, with the number of its samples, and the scatter about the mean as a bar.
function drawRegimes(pen, width, height, item, samples, theme) {
  const columns = columnsOf(samples, item.columns);
  const names = [...samples.regimes.keys()];
  const all = [...names.map((name) => [name, samples.regimes.get(name)]), ['All', samples.every]];
  const scatter = ({mean, rms}) => Math.sqrt(Math.max(rms * rms - mean * mean, 0));
  // Mean of all samples, plus and minus twice their scatter, so that the axis is independent of the
  // selection.
  const reach = all.flatMap(([, inside]) => columns.flatMap((column) => {
    const found = statistics(column.values, samples.indices([column], inside));
    if (found.count < fewSamples && inside !== samples.every) return [];
    return [found.mean - 2 * scatter(found), found.mean + 2 * scatter(found)];
  })).filter(Number.isFinite);
  const rows = all.map(([label, inside]) => {
    const found = columns.map((column) =>
      statistics(column.values, samples.indices([column], samples.selected.map((one, i) => one & inside[i]))));
    return {
      label: `${label} (${Math.max(...found.map(({count}) => count))})`,
      mark: names.includes(label) ? regimeMark(label, names, theme) : null,
      dots: found.map((one) => ({value: one.mean, error: scatter(one)})),
      text: `rms ${found.map(({rms}) => number(rms, 1e-3)).join(' → ')} ${columns[0].unit}`.trim(),
      found,
    };
  });
  const {box} = drawRows(pen, width, height,
    {rows, series: columns.map(({title}) => title), axis: sharedLabel(columns, item.axis), reach}, theme);
  return {
    points: columns.reduce((sum, column) => sum + samples.indices([column]).length, 0),
    plot: box,
    alternative: `Mean and scatter by regime: ${rows.map(({label, found}) => `${label}, rms ${found.map(({rms}) =>
      number(rms, 1e-3)).join(' and ')}`).join('; ')}`,
    table: {
      headers: ['Regime', ...columns.flatMap(({label}) => [`${label}, mean`, 'scatter', 'rms'])],
      rows: rows.map(({label, dots, found}) => [label, ...found.flatMap(({mean, rms}, c) =>
        [number(mean, 1e-3), number(dots[c].error, 1e-3), number(rms, 1e-3)])]),
    },
  };
}

Object.assign(pictures, {dots: drawDots, byregime: drawRegimes});
heights.dots = ({rows, series}) => dotsHeight(rows.length, series.length);
heights.byregime = ({columns}, samples) => dotsHeight(samples.regimes.size + 1, columns.length);
