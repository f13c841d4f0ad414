// Overview of the flight: columns over time, each on a separate axis, and below them a lane for every regime.

const lane = 15;

const stripLeft = 112;

function drawStrip(pen, width, height, item, samples, theme) {
  const columns = columnsOf(samples, item.columns)
    .map((column, c) => ({...column, colour: theme.series[c % theme.series.length]}));
  const names = [...samples.regimes.keys()];
  cover(pen, width, height, theme);
  const box = plotBox(width, height, {left: stripLeft, top: samples.flights.length > 1 ? 24 : 10});
  const lanes = names.length * lane + (names.length ? 8 : 0), gap = 10;
  const each = (box.height - lanes - gap * (columns.length - 1)) / columns.length;
  const [from, to] = samples.view;
  const x = scale(from, to, box.x, box.x + box.width);
  const placed = timeTicks(samples, samples.view, box.width / 64).map(({place, label}) => ({at: x(place), label}));
  const begin = samples.at(from).time, end = samples.at(to).time;
  horizontalTicks(pen, box, placed, `UTC, ${day(begin)}${day(end) === day(begin) ? '' : ` to ${day(end)}`}`, theme);
  if (samples.flights.length > 1)
    for (const flight of samples.flights) {
      const left = Math.max(x(flight.offset), box.x), right = Math.min(x(flight.offset + flight.duration), box.x + box.width);
      if (textWidth(flight.name, fontSize) < right - left) pen.text(left + 2, box.y - 6, flight.name, small(theme));
    }
  columns.forEach(({label, values, colour}, c) => {
    const part = {...box, y: box.y + c * (each + gap), height: each};
    const range = limits(valuesOf(samples, [columns[c]]));
    const y = scale(range.from, range.to, part.y + part.height, part.y);
    for (const tick of numberTicks(range.from, range.to, part.height, 26)) {
      const at = Math.round(y(tick.value)) + 0.5;
      pen.lines([[part.x, at, part.x + part.width, at]], theme.grid);
      pen.text(part.x - 7, at + 4, tick.label, small(theme, 'end'));
    }
    pen.text(13, part.y + part.height / 2, shortened(label, part.height + 8, fontSize), {...small(theme, 'middle'), turn: -90});
    frame(pen, part, theme, NaN);
    pen.clip(part, () => pen.lines(linePaths(samples, values, x, y), colour, 1.5));
  });
  names.forEach((name, n) => {
    const y = box.y + box.height - lanes + 8 + n * lane;
    const {colour, dash} = regimeMark(name, names, theme);
    const chosen = !samples.names.size || samples.names.has(name);
    pen.text(box.x - 7, y + 9, shortened(name, stripLeft - 12, smallSize), {...small(theme, 'end'), size: smallSize});
    pen.clip(box, () => {
      for (const interval of samples.intervals.filter((one) => one.name === name)) {
        const left = x(interval.begin), right = Math.max(x(interval.end), left + 1);
        const [mark, space] = dash ?? [right - left, 0];
        for (let at = left; at < right; at += mark + space)
          pen.rect(at, y + 1, Math.min(mark, right - at), lane - 5, colour, chosen ? 0.9 : 0.25);
      }
    });
  });
  return {
    points: columns.reduce((sum, column) => sum + samples.indices([column]).length, 0),
    plot: box,
    place: (i) => ({x: x(samples.position[i]), y: box.y}),
    alternative: `${listText(columns.map(({label}) => label))} over time, from ${clock(begin)} to ${clock(end)} UTC, with ` +
      `${names.length ? `the regimes ${listText(names)}` : 'no regimes'}`,
    table: statisticsTable(samples, columns),
  };
}

pictures.strip = drawStrip;
heights.strip = ({columns}, samples) => 62 + 128 * columns.length + lane * samples.regimes.size;
