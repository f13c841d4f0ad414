// Pictures. Each function draws an item with a pen on width x height and returns {points: samples drawn,
// plot: plot area, alternative: a sentence, table: {headers, rows}}.

const columnsOf = (samples, names) => names.map((name) => samples.columns.get(name));

// Visible columns of an item, each with its colour.
const curvesOf = (samples, item, theme) => columnsOf(samples, item.columns)
  .map((column, i) => ({...column, colour: theme.series[i % theme.series.length]}))
  .filter(({name}) => !item.hidden?.has(name));

const listText = (labels) => labels.length > 1 ? `${labels.slice(0, -1).join(', ')} and ${labels.at(-1)}` : labels[0];

// Axis label of several columns: the given words or the titles, and the unit if they share it.
function sharedLabel(columns, words) {
  const units = new Set(columns.map(({unit}) => unit));
  return withUnit(words || columns.map(({title}) => title).join(', '), units.size === 1 ? columns[0].unit : '');
}

function statisticsTable(samples, columns) {
  return {
    headers: ['', 'Samples', 'Least', 'Mean', 'Greatest', 'Rms'],
    rows: columns.map((column) => {
      const {count, least, mean, greatest, rms} = statistics(column.values, samples.indices([column]));
      return [column.label, countText(count), ...[least, mean, greatest, rms].map(brief)];
    }),
  };
}

// Positions of samples in a picture: x, y, x, y, ...
function places(indices, xs, ys, x, y) {
  const xy = new Float64Array(2 * indices.length);
  indices.forEach((i, n) => {
    xy[2 * n] = x(xs[i]);
    xy[2 * n + 1] = y(ys[i]);
  });
  return xy;
}

// Columns that determine a scale: columns that do not change interactively, if there are any.
const steady = (columns) => columns.some(({live}) => !live) ? columns.filter(({live}) => !live) : columns;

// All values of columns, selected or not: scales stay fixed during a selection.
const valuesOf = (samples, columns) => steady(columns).flatMap((column) =>
  samples.indices([column], samples.every).map((i) => column.values[i]));

// Minimum range of a vertical axis: smaller differences of pressure, hPa, are rounding errors.
const leastRange = (columns) => columns.every(({unit}) => unit === 'hPa') ? 0.1 : 0;

const cover = (pen, width, height, theme) => pen.rect(0, 0, width, height, theme.paper);

function drawPicture(pen, width, height, item, samples, theme) {
  cover(pen, width, height, theme);
  return pictures[item.kind](pen, width, height, item, samples, theme);
}

function shadeIntervals(pen, box, x, samples, theme) {
  const names = [...samples.regimes.keys()];
  const taken = [];  // left and right of the names drawn
  for (const {name, begin, end} of samples.intervals) {
    const left = Math.floor(Math.max(x(begin), box.x)), right = Math.ceil(Math.min(x(end), box.x + box.width));
    if (right <= left) continue;
    const chosen = !samples.names.size || samples.names.has(name);
    const mark = regimeMark(name, names, theme);
    pen.rect(left, box.y, right - left, box.height, mark.colour, chosen ? 0.08 : 0.02);
    dashes(pen, left, right, box.y, 4, mark, chosen ? 0.8 : 0.2);
    const covered = samples.intervals.some((other) =>
      other.end - other.begin < end - begin && other.begin <= (begin + end) / 2 && other.end >= (begin + end) / 2);
    const middle = (left + right) / 2, half = textWidth(name, smallSize) / 2;
    if (covered || 2 * half > right - left - 6 || taken.some(([from, to]) => from < middle + half && to > middle - half)) continue;
    taken.push([middle - half, middle + half]);
    pen.text(middle, box.y + 15, name, {fill: theme.quiet, size: smallSize, align: 'middle'});
  }
}

// Lines of a column: within a pixel only the first, minimum, maximum and last value.
function linePaths(samples, values, x, y) {
  const paths = [];
  let path = null, pixel = null;
  const flush = () => {
    if (!pixel) return;
    const inOrder = [pixel.first, ...[pixel.least, pixel.greatest].sort((a, b) => a - b), pixel.last];
    inOrder.forEach((i, k) => { if (k === 0 || i !== inOrder[k - 1]) path.push(x(samples.position[i]), y(values[i])); });
    pixel = null;
  };
  for (let i = 0; i < samples.count; ++i) {
    if (samples.breaks[i] || !samples.selected[i] || Number.isNaN(values[i])) {
      flush();
      path = null;
      if (!samples.selected[i] || Number.isNaN(values[i])) continue;
    }
    if (!path) paths.push(path = []);
    const place = Math.floor(x(samples.position[i]));
    if (pixel && pixel.place !== place) flush();
    pixel ??= {place, first: i, least: i, greatest: i};
    if (values[i] < values[pixel.least]) pixel.least = i;
    if (values[i] > values[pixel.greatest]) pixel.greatest = i;
    pixel.last = i;
  }
  flush();
  // An isolated sample is a short stroke.
  return paths.map((one) => one.length > 2 ? one : [one[0] - 1.5, one[1], one[0] + 1.5, one[1]]);
}

// Means over periods of `seconds`, at every sample that has a value.
function periodMeans(samples, values, seconds) {
  const means = new Float64Array(values.length).fill(NaN);
  for (let first = 0, end = 0; first < samples.count; first = end) {
    const period = Math.floor(samples.position[first] / seconds);
    let sum = 0, count = 0;
    for (; end < samples.count && Math.floor(samples.position[end] / seconds) === period; ++end)
      if (!Number.isNaN(values[end])) { sum += values[end]; ++count; }
    for (let i = first; i < end; ++i) if (!Number.isNaN(values[i])) means[i] = sum / count;
  }
  return means;
}

// Strokes from value - error to value + error, one for each pixel, and their width.
function bandPaths(samples, {values}, {values: errors}, x, y) {
  const paths = [];
  let path = null;
  for (let i = 0; i < samples.count; ++i) {
    const [low, high] = [values[i] - errors[i], values[i] + errors[i]].map(y);
    if (!samples.selected[i] || !Number.isFinite(low)) continue;
    const at = Math.floor(x(samples.position[i])) + 0.5;
    if (path?.[0] !== at) paths.push(path = [at, low, at, high]);
    path[1] = Math.max(path[1], low);
    path[3] = Math.min(path[3], high);
  }
  const [from, to] = samples.view;
  return {paths, width: Math.max(1, (x(to) - x(from)) / Math.max(samples.nearest(to) - samples.nearest(from), 1))};
}

function drawTime(pen, width, height, item, samples, theme) {
  const recorded = curvesOf(samples, item, theme);
  const columns = item.averaging_time
    ? recorded.map((column) => ({...column, values: periodMeans(samples, column.values, item.averaging_time)})) : recorded;
  const error = samples.columns.get(item.uncertainty);
  const entries = columns.map(({title, colour}) => ({label: title, colour}));
  const key = item.columns.length > 1;
  const named = samples.flights.length > 1 ? 15 : 0;
  const top = (key ? legend(pen, entries, margin, width - 14, theme) : 10) + named;
  const box = plotBox(width, height, {top});
  const [from, to] = samples.view;
  const x = scale(from, to, box.x, box.x + box.width);
  const found = columns.map((column) => samples.indices([column]));
  const ends = error ? [-1, 1].flatMap((sign) => samples.indices([columns[0], error], samples.every)
    .map((i) => columns[0].values[i] + sign * error.values[i])) : [];
  const range = limits(valuesOf(samples, columns).concat(ends), [], leastRange(columns));
  range.to += samples.intervals.length ? 0.09 * (range.to - range.from) : 0;
  Object.assign(range, item.vertical);
  const y = scale(range.from, range.to, box.y + box.height, box.y);

  verticalAxis(pen, box, y, range, sharedLabel(columns, item.axis), theme);
  const rangeWords = timeAxis(pen, box, x, samples, theme);
  shadeIntervals(pen, box, x, samples, theme);
  frame(pen, box, theme, range.from < 0 ? y(0) : NaN);
  nameFlights(pen, box, x, samples, 5, theme);
  pen.clip(box, () => {
    if (error) {
      const band = bandPaths(samples, columns[0], error, x, y);
      pen.lines(band.paths, columns[0].colour, band.width, [], 0.25);
    }
    columns.forEach(({values, colour}) => pen.lines(linePaths(samples, values, x, y), colour, 1.25));
  });
  tellBeyond(pen, box, range.beyond, theme);
  return {
    points: found.reduce((sum, indices) => sum + indices.length, 0),
    plot: box,
    place: (i) => ({x: x(samples.position[i]), y: y(columns[0].values[i])}),
    up: (pixel) => range.from + (box.y + box.height - pixel) / box.height * (range.to - range.from),
    alternative: `Lines over time, ${rangeWords}: ${listText(columns.map(({label}) => label))}` +
      `${error ? `, in a band of the ${error.label}` : ''}`,
    table: statisticsTable(samples, error ? [...recorded, error] : recorded),
  };
}

// Mean of y in bins of x, with its standard error.
function binned(xs, ys, indices, {from, to}, autocorrelationTime) {
  const bins = 12;
  const all = Array.from({length: bins}, (_, b) =>
    ({middle: from + (b + 0.5) * (to - from) / bins, count: 0, sum: 0, squares: 0}));
  for (const i of indices) {
    const bin = all[Math.min(Math.floor((xs[i] - from) / (to - from) * bins), bins - 1)];
    if (!bin) continue;
    bin.count += 1;
    bin.sum += ys[i];
    bin.squares += ys[i] * ys[i];
  }
  return all.map(({middle, count, sum, squares}) => {
    const mean = sum / count;
    const variance = Math.max(squares / count - mean * mean, 0) * count / Math.max(count - 1, 1);
    return {middle, count, mean, error: Math.sqrt(variance / Math.max(count / autocorrelationTime, 1))};
  });
}

// Meaning of the error bars of bins. @param autocorrelationTime in samples, at least 1
const barsText = (autocorrelationTime) => autocorrelationTime >= 1.05
  ? `Bars: standard error of the mean; ${Number(autocorrelationTime.toPrecision(2))} samples count as one, because fast noise is correlated.`
  : 'Bars: standard error of the mean, for independent samples.';

const fewest = 5;  // minimum number of samples in a visible bin

// Visible bins, in runs without a gap.
function neighbours(bins) {
  const runs = [[]];
  for (const bin of bins) {
    if (bin.count >= fewest) runs.at(-1).push(bin);
    else runs.push([]);
  }
  return runs.filter((run) => run.length);
}

function drawBinned(pen, width, height, item, samples, theme) {
  const columns = curvesOf(samples, item, theme);
  const abscissa = samples.columns.get(item.choice ?? item.x_choices[0]);
  const found = columns.map((column) => samples.indices([abscissa, column]));
  const whole = columns.map((column) => samples.indices([abscissa, column], samples.every));
  const entries = columns.map(({title, colour}) => ({label: title, colour}));
  const box = plotBox(width, height, {top: legend(pen, entries, margin, width - 14, theme)});
  const across = limits(whole.flatMap((indices) => indices.map((i) => abscissa.values[i])));
  const bins = columns.map(({values}, c) =>
    binned(abscissa.values, values, found[c], across, item.autocorrelation_time));
  const shown = bins.map((all) => all.filter(({count}) => count >= fewest));
  const steadily = (of) => steady(columns).flatMap((column) => of(column, columns.indexOf(column)));
  const up = limits(steadily(({values}, c) => whole[c].map((i) => values[i])),
    steadily((column, c) => shown[c]).flatMap(({mean, error}) => [mean - error, mean + error]),
    leastRange(columns));
  const x = scale(across.from, across.to, box.x, box.x + box.width);
  const y = scale(up.from, up.to, box.y + box.height, box.y);
  verticalAxis(pen, box, y, up, sharedLabel(columns, item.axis), theme);
  horizontalAxis(pen, box, x, across, abscissa.label, theme);
  frame(pen, box, theme, y(0));
  pen.clip(box, () => {
    columns.forEach(({values}, c) =>
      pen.dots(places(found[c], abscissa.values, values, x, y), 2, entries[c].colour, 0.2));
    shown.forEach((all, c) => {
      const aside = (c - (columns.length - 1) / 2) * 5;
      const marks = all.flatMap(({middle, mean}) => [x(middle) + aside, y(mean)]);
      const paths = neighbours(bins[c]).map((run) => run.flatMap(({middle, mean}) => [x(middle) + aside, y(mean)]));
      const bars = all.map(({middle, mean, error}) =>
        [x(middle) + aside, y(mean - error), x(middle) + aside, y(mean + error)]);
      const caps = all.flatMap(({middle, mean, error}) => [mean - error, mean + error].map((end) =>
        [x(middle) + aside - 3.5, y(end), x(middle) + aside + 3.5, y(end)]));
      pen.lines(paths, theme.paper, 4);
      pen.lines([...bars, ...caps], theme.paper, 3.5);
      pen.lines(paths, entries[c].colour, 1.75);
      pen.lines([...bars, ...caps], entries[c].colour, 1.5);
      pen.dots(marks, 7, entries[c].colour);
    });
  });
  tellBeyond(pen, box, across.beyond + up.beyond, theme);
  return {
    points: found.reduce((sum, indices) => sum + indices.length, 0),
    plot: box,
    place: (i) => ({x: x(abscissa.values[i]), y: y(columns[0].values[i])}),
    alternative: `Mean and standard error of ${listText(columns.map(({label}) => label))} in bins of ${abscissa.label}`,
    table: {
      headers: [abscissa.label, ...columns.flatMap(({title}) => ['Samples', title])],
      rows: bins[0].map(({middle}, b) => [brief(middle), ...bins.flatMap((all) => {
        const {count, mean, error} = all[b];
        return [countText(count), count >= fewest ? withError(mean, error) : '–'];
      })]),
    },
  };
}

const levels = 48;  // number of colours

// A colour bar has the title of its column up to the first comma as label; the title of the picture has the rest.
function colourBar(pen, box, colours, {from, to}, {title, unit}, theme) {
  const x = box.x + box.width + 14, width = 11;
  const part = box.height / levels;
  for (let i = 0; i < levels; ++i)
    pen.rect(x, box.y + box.height - (i + 1) * part, width, part + 0.5, mixed(colours, i / (levels - 1)));
  const y = scale(from, to, box.y + box.height, box.y);
  for (const tick of numberTicks(from, to, box.height, 30))
    pen.text(x + width + 5, y(tick.value) + 4, tick.label, small(theme));
  const label = shortened(withUnit(title.split(',')[0], unit), box.height + labelBeyond, fontSize);
  pen.text(x + width + 56, box.y + box.height / 2, label, {...small(theme, 'middle'), turn: -90});
}

// Colours of a column over its range among the samples `whole`: centred on zero if diverging. `paint` draws
// dots of some size at places of samples, the strongest colours of either sign last, on top.
function shading(diverging, {values}, whole, theme) {
  const sorted = Float64Array.from(whole, (i) => diverging ? Math.abs(values[i]) : values[i]).sort();
  const greatest = sorted[Math.floor(0.99 * (sorted.length - 1))] || 1;
  const range = diverging ? {from: -greatest, to: greatest} : limits(sorted);
  const colours = diverging ? theme.diverging : theme.sequential;
  const level = scale(range.from, range.to, 0, levels - 1);
  const paint = (pen, found, place, size) => {
    const dots = Array.from({length: levels}, () => []);
    for (const i of found) dots[Math.min(Math.max(Math.round(level(values[i])), 0), levels - 1)].push(...place(i));
    const order = [...dots.keys()];
    if (diverging) order.sort((a, b) => Math.abs(a - levels / 2 + 0.5) - Math.abs(b - levels / 2 + 0.5));
    for (const l of order) pen.dots(dots[l], size, mixed(colours, l / (levels - 1)));
  };
  return {range, colours, paint};
}

function drawPlane(pen, width, height, item, samples, theme) {
  const [across, up, shade] = columnsOf(samples, [item.x, item.y, item.colour]);
  const found = samples.indices([across, up, shade]);
  const whole = samples.indices([across, up, shade], samples.every);
  const box = plotBox(width, height, {right: 84});
  const xs = limits(whole.map((i) => across.values[i])), ys = limits(whole.map((i) => up.values[i]));
  const {range, colours, paint} = shading(true, shade, whole, theme);
  const x = scale(xs.from, xs.to, box.x, box.x + box.width);
  const y = scale(ys.from, ys.to, box.y, box.y + box.height);
  verticalAxis(pen, box, y, ys, up.label, theme);
  horizontalAxis(pen, box, x, xs, across.label, theme);
  frame(pen, box, theme, NaN);
  pen.clip(box, () => paint(pen, found, (i) => [x(across.values[i]), y(up.values[i])], 3));
  colourBar(pen, box, colours, range, shade, theme);
  tellBeyond(pen, box, xs.beyond + ys.beyond, theme);
  return {
    points: found.length,
    plot: box,
    place: (i) => ({x: x(across.values[i]), y: y(up.values[i])}),
    alternative: `${shade.label} by colour, in the plane of ${across.label} and ${up.label}`,
    table: statisticsTable(samples, [across, up, shade]),
  };
}

function drawPair(pen, width, height, item, samples, theme) {
  const [across, up] = columnsOf(samples, [item.x, item.y]);
  const found = samples.indices([across, up]);
  const {lines} = item;
  const entries = lines.map(({label}, i) =>
    ({label, colour: theme.series[(i + 1) % theme.series.length], dash: i ? [6, 4] : []}));
  const both = plotBox(width, height, {top: legend(pen, entries, margin, width - 14, {...theme, named: false})});
  const upper = {...both, height: Math.round(0.6 * both.height)};
  const lower = {...both, y: upper.y + upper.height + 16, height: both.height - upper.height - 16};
  const whole = samples.indices([across, up], samples.every);
  const xs = limits(whole.map((i) => across.values[i])), ys = limits(whole.map((i) => up.values[i]));
  const differences = up.values.map((value, i) => value - lines[0].offset - lines[0].slope * across.values[i]);
  const ds = limits(whole.map((i) => differences[i]));
  const x = scale(xs.from, xs.to, both.x, both.x + both.width);
  const y = scale(ys.from, ys.to, upper.y + upper.height, upper.y);
  const d = scale(ds.from, ds.to, lower.y + lower.height, lower.y);
  verticalAxis(pen, upper, y, ys, up.label, theme);
  for (const tick of numberTicks(xs.from, xs.to, upper.width, 76)) {
    const at = Math.round(x(tick.value)) + 0.5;
    pen.lines([[at, upper.y, at, upper.y + upper.height]], theme.grid);
  }
  frame(pen, upper, theme, NaN);
  pen.clip(upper, () => {
    pen.dots(places(found, across.values, up.values, x, y), 2.5, theme.series[0], 0.5);
    lines.forEach(({slope, offset}, i) => {
      const path = [xs.from, xs.to].flatMap((value) => [x(value), y(offset + slope * value)]);
      pen.lines([path], entries[i].colour, 1.75, entries[i].dash);
    });
  });
  verticalAxis(pen, lower, d, ds, withUnit('Difference', up.unit), theme);
  horizontalAxis(pen, lower, x, xs, across.label, theme);
  frame(pen, lower, theme, d(0));
  pen.clip(lower, () => pen.dots(places(found, across.values, differences, x, d), 2, theme.series[0], 0.35));
  tellBeyond(pen, lower, ds.beyond, theme);
  const residual = statistics(differences, found);
  return {
    points: found.length,
    plot: both,
    place: (i) => ({x: x(across.values[i]), y: y(up.values[i])}),
    alternative: `${up.label} against ${across.label}, and below it the difference from ${lines[0].label}: ` +
        `bias ${brief(residual.mean)}, rms ${brief(residual.rms)}${up.unit ? ` ${up.unit}` : ''}`,
    table: {
      headers: ['Line', 'Slope', 'Offset', 'Bias', 'Rms'],
      rows: lines.map(({slope, offset, label}) => {
        const {mean, rms} = statistics(up.values.map((value, i) => value - offset - slope * across.values[i]), found);
        return [label, number(slope, 1e-5), brief(offset), brief(mean), brief(rms)];
      }),
    },
  };
}

function drawBars(pen, width, height, item, samples, theme) {
  const bars = item.bars.map(({label, value, error}) => ({label, value: value ?? NaN, error: error ?? 0}));
  const finite = bars.filter(({value}) => Number.isFinite(value));
  const longest = Math.max(...bars.map(({label}) => textWidth(label, fontSize)));
  const left = Math.min(longest + 22, 0.55 * width);
  const box = plotBox(width, height, {left, right: 62, top: 8});
  const range = limits(finite.flatMap(({value, error}) => [value - error, value + error]), [0]);
  if (finite.every(({value, error}) => value - error >= 0)) range.from = 0;
  const x = scale(range.from, range.to, box.x, box.x + box.width);
  horizontalAxis(pen, box, x, range, withUnit(item.axis, item.unit).trim(), theme);
  const room = box.height / bars.length, thick = Math.min(0.5 * room, 18);
  bars.forEach(({label, value, error}, i) => {
    const middle = box.y + (i + 0.5) * room;
    pen.text(box.x - 9, middle + 4, shortened(label, left - 18, fontSize), {...small(theme, 'end'), fill: theme.ink});
    if (!Number.isFinite(value)) return;
    const [begin, end] = [x(0), x(value)].sort((a, b) => a - b);
    pen.rect(begin, middle - thick / 2, Math.max(end - begin, 1), thick, theme.series[0]);
    if (error > 0) errorBar(pen, x(value - error), x(value + error), middle, theme.ink, 1.25);
    pen.text(Math.max(x(value + error), x(0)) + 7, middle + 4, brief(value), small(theme));
  });
  pen.lines([[Math.round(x(0)) + 0.5, box.y, Math.round(x(0)) + 0.5, box.y + box.height]], theme.frame);
  return {
    points: finite.length,
    plot: box,
    alternative: `Bars of ${withUnit(item.axis || 'values', item.unit)}: ${plural(bars.length, 'bar')}`,
    table: {
      headers: ['', withUnit(item.axis || 'Value', item.unit), 'Error'],
      rows: bars.map(({label, value, error}) => [label, brief(value), error ? brief(error) : '–']),
    },
  };
}

function drawCurves(pen, width, height, item, samples, theme) {
  const curves = item.curves.map(({label, x, y, error}, c) => ({
    label, colour: theme.series[c % theme.series.length],
    points: x.map((value, i) => ({x: value, y: y[i] ?? NaN, error: error[i] ?? 0})).filter((point) => Number.isFinite(point.y)),
  }));
  const shown = curves.flatMap(({points}) => points);
  const box = plotBox(width, height, {top: legend(pen, curves, margin, width - 14, {...theme, named: false})});
  const across = {from: Math.min(...shown.map((point) => point.x)), to: Math.max(...shown.map((point) => point.x))};
  const up = limits(shown.flatMap(({y, error}) => [y - error, y + error]));
  const place = scale(Math.log(across.from), Math.log(across.to), box.x, box.x + box.width);
  const x = (value) => place(Math.log(value));
  const y = scale(up.from, up.to, box.y + box.height, box.y);
  verticalAxis(pen, box, y, up, withUnit(item.axis, item.unit), theme);
  logarithmicAxis(pen, box, place, across, withUnit(item.x_axis, item.x_unit), theme);
  frame(pen, box, theme, y(0));
  pen.clip(box, () => curves.forEach(({points, colour}) => {
    pen.lines(points.filter(({error}) => error > 0).map((point) =>
      [x(point.x), y(point.y - point.error), x(point.x), y(point.y + point.error)]), colour, 1);
    pen.lines([points.flatMap((point) => [x(point.x), y(point.y)])], colour, 1.75);
    pen.dots(points.flatMap((point) => [x(point.x), y(point.y)]), 4, colour);
  }));
  tellBeyond(pen, box, up.beyond, theme);
  return {
    points: shown.length,
    plot: box,
    alternative: `${item.axis} against ${item.x_axis}: ${listText(curves.map(({label}) => label))}`,
    table: {
      headers: ['Curve', withUnit(item.x_axis, item.x_unit), withUnit(item.axis, item.unit)],
      rows: curves.flatMap(({label, points}) =>
        points.map((point) => [label, brief(point.x), point.error ? withError(point.y, point.error) : brief(point.y)])),
    },
  };
}

// Every bar has a separate row, if the picture is high enough.
const heightOfBars = ({bars}) => 70 + 30 * Math.min(Math.max(bars.length, 2), 40);

// Heights of pictures that do not follow their width.
const heights = {bars: heightOfBars};

const pictures = {time: drawTime, binned: drawBinned, plane: drawPlane, pair: drawPair, bars: drawBars, curves: drawCurves};
