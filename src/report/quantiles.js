// Comparison of values with a normal distribution by quantiles.

// Quantile of the standard normal distribution, from its integral in small steps.
const normalQuantile = (() => {
  const step = 0.005, most = 5, parts = [0];
  for (let x = -most + step / 2; x < most; x += step)
    parts.push(parts.at(-1) + step * Math.exp(-x * x / 2) / Math.sqrt(2 * Math.PI));
  return (part) => {
    const high = firstWhere(1, parts.length - 1, (i) => parts[i] >= part), low = high - 1;
    return -most + step * (low + (part - parts[low]) / (parts[high] - parts[low]));
  };
})();

const mostQuantiles = 300;

// Values at equal probability steps, including minimum and maximum.
function quantilesOf(sorted) {
  const ends = sorted.length > mostQuantiles ? normalQuantile(1 - 0.5 / sorted.length) : 0;
  const count = Math.min(sorted.length, mostQuantiles);
  return Array.from({length: count}, (_, n) => {
    if (!ends) return {x: normalQuantile((n + 0.5) / count), y: sorted[n]};
    const wanted = -ends + 2 * ends * n / (count - 1);
    const low = firstWhere(0, sorted.length - 1, (i) => normalQuantile((i + 0.5) / sorted.length) >= wanted);
    return {x: normalQuantile((low + 0.5) / sorted.length), y: sorted[low]};
  });
}

function drawQuantiles(pen, width, height, item, samples, theme) {
  const columns = curvesOf(samples, item, theme);
  const entries = columns.map(({title, colour}) => ({label: title, colour}));
  const sortedOf = (column, mask) =>
    Float64Array.from(samples.indices([column], mask), (i) => column.values[i]).sort();
  const all = columns.map((column) => {
    const sorted = sortedOf(column, samples.selected);
    const at = (part) => sorted[Math.round(part * (sorted.length - 1))];
    const spread = (at(0.75) - at(0.25)) / (2 * normalQuantile(0.75));
    return {...column, sorted, middle: at(0.5), spread, quantiles: quantilesOf(sorted)};
  });
  const box = plotBox(width, height, {top: legend(pen, entries, margin, width - 14, theme)});
  const most = normalQuantile(1 - 0.5 / Math.max(samples.count, 2));
  const across = {from: -most - 0.2, to: most + 0.2};
  const up = limits(columns.flatMap((column) => {
    const whole = sortedOf(column, samples.every);
    return [whole[0], whole[whole.length - 1]].filter(Number.isFinite);
  }));
  const x = scale(across.from, across.to, box.x, box.x + box.width);
  const y = scale(up.from, up.to, box.y + box.height, box.y);
  verticalAxis(pen, box, y, up, sharedLabel(columns, item.axis), theme);
  horizontalAxis(pen, box, x, across, 'normal quantile (standard deviations)', theme);
  frame(pen, box, theme, y(0));
  pen.clip(box, () => all.forEach(({quantiles, middle, spread, colour}) => {
    const line = [across.from, across.to].flatMap((at) => [x(at), y(middle + spread * at)]);
    if (Number.isFinite(spread)) pen.lines([line], colour, 1.25, [6, 4]);
    pen.dots(quantiles.flatMap((point) => [x(point.x), y(point.y)]), 4, colour);
  }));
  const beyond = ({sorted, middle, spread}) =>
    sorted.filter((value) => Math.abs(value - middle) > 3 * spread).length / sorted.length;
  return {
    points: all.reduce((sum, {sorted}) => sum + sorted.length, 0),
    plot: box,
    alternative: `Quantiles against the quantiles of a normal distribution; beyond three standard deviations, of which a normal ` +
      `distribution has 0.27 %, lie ${listText(all.map((each) =>
        `${number(100 * beyond(each), 0.01)} % of ${each.title}`))}`,
    table: {
      headers: ['', 'Samples', 'Median', 'Standard deviation, from the quartiles', 'Beyond 3 standard deviations', 'Normal distribution'],
      rows: all.map((each) => [each.label, countText(each.sorted.length), brief(each.middle), brief(each.spread),
        `${number(100 * beyond(each), 0.01)} %`, '0.27 %']),
    },
  };
}

pictures.quantiles = drawQuantiles;
