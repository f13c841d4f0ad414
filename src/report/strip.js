// Overview of the flight: columns over time, each on a separate axis, and below them a lane for every regime.

const lane = 15;

const stripLeft = 112;

function drawStrip(pen, width, height, item, samples, theme) {
  const columns = columnsOf(samples, item.columns)
    .map((column, c) => ({...column, colour: theme.series[c % theme.series.length]}));
  const names = [...samples.regimes.keys()];
  const box = plotBox(width, height, {left: stripLeft, top: samples.flights.length > 1 ? 24 : 10});
  const lanes = names.length * lane + (names.length ? 8 : 0), gap = 10;
  const each = (box.height - lanes - gap * (columns.length - 1)) / columns.length;
  const [from, to] = samples.view;
  const x = scale(from, to, box.x, box.x + box.width);
  const rangeWords = timeAxis(pen, box, x, samples, theme);
  nameFlights(pen, box, x, samples, 6, theme);
  columns.forEach(({label, values, colour}, c) => {
    const part = {...box, y: box.y + c * (each + gap), height: each};
    const range = limits(valuesOf(samples, [columns[c]]));
    const y = scale(range.from, range.to, part.y + part.height, part.y);
    verticalAxis(pen, part, y, range, label, theme, 26, 8);
    frame(pen, part, theme, NaN);
    pen.clip(part, () => pen.lines(linePaths(samples, values, x, y), colour, 1.5));
  });
  names.forEach((name, n) => {
    const y = box.y + box.height - lanes + 8 + n * lane;
    const mark = regimeMark(name, names, theme);
    const chosen = !samples.names.size || samples.names.has(name);
    pen.text(box.x - 7, y + 9, shortened(name, stripLeft - 12, smallSize), {...small(theme, 'end'), size: smallSize});
    pen.clip(box, () => {
      for (const interval of samples.intervals.filter((one) => one.name === name)) {
        const left = x(interval.begin), right = Math.max(x(interval.end), left + 1);
        dashes(pen, left, right, y + 1, lane - 5, mark, chosen ? 0.9 : 0.25);
      }
    });
  });
  return {
    points: columns.reduce((sum, column) => sum + samples.indices([column]).length, 0),
    plot: box,
    place: (i) => ({x: x(samples.position[i]), y: box.y}),
    alternative: `${listText(columns.map(({label}) => label))} over time, ${rangeWords}, with ` +
      `${names.length ? `the regimes ${listText(names)}` : 'no regimes'}`,
    table: statisticsTable(samples, columns),
  };
}

pictures.strip = drawStrip;
heights.strip = ({columns}, samples) => 62 + 128 * columns.length + lane * samples.regimes.size;
