// Colours, scales, ticks and the frame of a plot.

// Colours after Okabe and Ito, which colour-blind readers can distinguish; lighter on a dark page.
const palettes = {
  light: {
    paper: '#ffffff', ink: '#1c2126', quiet: '#5c6670', grid: '#e8eaec', frame: '#9aa3ab',
    series: ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#b8860b', '#56b4e9'],
    regimes: ['#56b4e9', '#e69f00', '#009e73', '#cc79a7', '#0072b2', '#8a9299'],
    diverging: ['#053f73', '#2f7ebc', '#d2d4d3', '#e08214', '#8c3a04'],
    sequential: ['#440154', '#3b528b', '#21918c', '#5ec962', '#d9c71e'],
  },
  dark: {
    paper: '#171b1f', ink: '#e6e9ec', quiet: '#9ba5ae', grid: '#282e34', frame: '#5b656e',
    series: ['#5cb3f0', '#f08a4b', '#35c498', '#e39cc4', '#e0b440', '#a8d8f5'],
    regimes: ['#56b4e9', '#e6a520', '#35c498', '#e39cc4', '#4d8fe0', '#9ba5ae'],
    diverging: ['#9fd4ff', '#3f8fd0', '#4a5157', '#d98324', '#ffd29a'],
    sequential: ['#7a5bb8', '#4f7fc4', '#2fa8a0', '#6fce70', '#f3e45a'],
  },
};

// Standard regimes of pcor, which have the same mark in every report; others follow.
const knownRegimes = ['climb', 'descent', 'level', 'turn', 'take-off', 'ground', 'circle', 'cloud', 'pitch manoeuvre',
  'yaw manoeuvre', 'speed run', 'reverse heading'];

// Colour of a regime, and dashes that distinguish it from the previous one with that colour: every colour
// twice, solid and dashed, then dotted.
function regimeMark(name, names, theme) {
  const known = knownRegimes.indexOf(name);
  const others = names.filter((each) => !knownRegimes.includes(each));
  const place = known >= 0 ? known : knownRegimes.length + others.indexOf(name);
  const dashes = [null, [6, 4], [2, 3]];
  return {
    colour: theme.regimes[place % theme.regimes.length],
    dash: dashes[Math.floor(place / theme.regimes.length) % dashes.length],
  };
}

// Colour at `part`, from 0 to 1, of equidistant colours.
function mixed(colours, part) {
  const place = Math.min(Math.max(part, 0), 1) * (colours.length - 1);
  const below = Math.min(Math.floor(place), colours.length - 2);
  const channel = (colour, i) => parseInt(colour.slice(1 + 2 * i, 3 + 2 * i), 16);
  const hex = [0, 1, 2].map((i) => {
    const from = channel(colours[below], i), to = channel(colours[below + 1], i);
    return Math.round(from + (to - from) * (place - below)).toString(16).padStart(2, '0');
  });
  return `#${hex.join('')}`;
}

function scale(from, to, begin, end) {
  const factor = (end - begin) / (to - from);
  return (value) => begin + (value - from) * factor;
}

// Minimum and maximum with a small margin. If a few values lie far out, the limits exclude them: `beyond` is
// their number. `always` lies within. The minimum range is `least`.
function limits(values, always = [], least = 0) {
  const sorted = Float64Array.from(values).sort();
  const last = sorted.length - 1;
  if (last < 0 && !always.length) return {from: 0, to: 1, beyond: 0};
  let from = sorted[0] ?? Infinity, to = sorted[last] ?? -Infinity;
  const low = sorted[Math.floor(0.005 * last)], high = sorted[Math.ceil(0.995 * last)];
  if (to - from > 2.5 * (high - low) && high > low) {
    from = Math.max(from, low - 0.25 * (high - low));
    to = Math.min(to, high + 0.25 * (high - low));
  }
  from = Math.min(from, ...always);
  to = Math.max(to, ...always);
  const beyond = sorted.filter((value) => value < from || value > to).length;
  const own = to > from ? 0.04 * (to - from) : Math.max(0.5 * Math.abs(to), 1e-3);
  const room = Math.max(own, (least - (to - from)) / 2);
  return {from: from - room, to: to + room, beyond};
}

function ticks(from, to, about) {
  const raw = (to - from) / Math.max(about, 1);
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= raw * 0.999);
  const all = [];
  const first = Math.ceil(from / step - 1e-9), last = Math.floor(to / step + 1e-9);
  for (let n = 0; n <= Math.min(last - first, 1000); ++n) all.push((first + n) * step);
  return {step, all};
}

// Number rounded to the resolution of a step, with a true minus.
function number(value, step) {
  if (!Number.isFinite(value)) return '–';
  const large = Math.max(Math.abs(value), step);
  if (large >= 1e6 || step < 1e-5) return value === 0 ? '0' : value.toExponential(1).replaceAll('-', '−');
  const digits = Math.max(0, Math.ceil(-Math.log10(step) - 1e-6));
  const text = value.toFixed(digits);
  return (Number(text) === 0 ? text.replace('-', '') : text).replace('-', '−');
}

// Number with three significant digits.
function brief(value) {
  const step = value === 0 || !Number.isFinite(value) ? 1 : 10 ** (Math.floor(Math.log10(Math.abs(value))) - 2);
  return number(value, Math.min(step, 1));
}

// Mean rounded to the precision of its error.
function withError(mean, error) {
  const step = error > 0 ? 10 ** Math.min(Math.floor(Math.log10(error)) - 1, 0) : 1e-3;
  return `${number(mean, step)} ± ${number(error, step)}`;
}

const countText = (count) => count.toLocaleString('en-GB').replaceAll(',', '\u202f');

const plural = (count, one) => `${countText(count)} ${one}${count === 1 ? '' : 's'}`;

function clock(time, seconds = true) {
  return new Date(Math.round(time * 1000)).toISOString().slice(11, seconds ? 19 : 16);
}

const day = (time) => new Date(time * 1000).toISOString().slice(0, 10);

const timeSteps = [1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 10800, 21600, 43200, 86400];

// Round times of day on the time axis, flight by flight; short flights next to others may need more of them.
function timeTicks(samples, [from, to], about) {
  let place = timeSteps.findIndex((one) => one * about >= to - from);
  if (place < 0) place = timeSteps.length - 1;
  let all = timesOfDay(samples, from, to, timeSteps[place]);
  while (all.length < 2 && place > 0) all = timesOfDay(samples, from, to, timeSteps[--place]);
  return all;
}

function timesOfDay(samples, from, to, step) {
  const all = [];
  for (const {start, offset, duration} of samples.flights) {
    const end = start + duration;
    for (let time = Math.ceil(start / step) * step; time <= end; time += step) {
      const place = offset + time - start;
      if (place >= from && place <= to) all.push({place, label: clock(time, step < 60)});
    }
  }
  return all;
}

const fontSize = 11.5;

const smallSize = 10.7;  // 8 points in print, the smallest character size

const margin = 68;  // left margin for the numbers and the axis label

const rightMargin = 14;  // smallest right margin of a plot

const small = (theme, align = 'start') => ({fill: theme.quiet, size: fontSize, align});

// Plot area of a picture: margins for the axes, and for a legend of `lines`.
function plotBox(width, height, {left = margin, right = rightMargin, top = 12, bottom = 44} = {}) {
  return {x: left, y: top, width: width - left - right, height: height - top - bottom};
}

// Two numbers at least, also on a short axis.
function numberTicks(from, to, length, distance) {
  let about = length / distance;
  let {step, all} = ticks(from, to, about);
  for (let finer = 0; all.length < 2 && finer < 4; ++finer) ({step, all} = ticks(from, to, about *= 1.5));
  return all.map((value) => ({value, label: number(value, step)}));
}

const labelBeyond = 24;  // a label along a plot may be longer than the plot by this

// Grid and numbers of the vertical axis; its label is turned along it, and may be longer by `beyond`.
function verticalAxis(pen, box, y, {from, to}, label, theme, distance = 30, beyond = labelBeyond) {
  for (const tick of numberTicks(from, to, box.height, distance)) {
    const at = Math.round(y(tick.value)) + 0.5;
    pen.lines([[box.x, at, box.x + box.width, at]], theme.grid);
    pen.text(box.x - 7, at + 4, tick.label, small(theme, 'end'));
  }
  pen.text(13, box.y + box.height / 2, shortened(label, box.height + beyond, fontSize), {...small(theme, 'middle'), turn: -90});
}

function horizontalTicks(pen, box, placed, label, theme) {
  const base = box.y + box.height, end = box.x + box.width + rightMargin;
  for (const {at, label: words} of placed) {
    const x = Math.round(at) + 0.5;
    pen.lines([[x, box.y, x, base]], theme.grid);
    pen.text(Math.min(x, end - textWidth(words, fontSize) / 2), base + 17, words, small(theme, 'middle'));
  }
  pen.text(box.x + box.width / 2, base + 36, shortened(label, box.width + 2 * rightMargin, fontSize), small(theme, 'middle'));
}

function horizontalAxis(pen, box, x, {from, to}, label, theme, distance = 76) {
  const placed = numberTicks(from, to, box.width, distance).map((tick) => ({at: x(tick.value), label: tick.label}));
  horizontalTicks(pen, box, placed, label, theme);
}

// Grid and numbers of a horizontal logarithmic axis.
function logarithmicAxis(pen, box, x, {from, to}, label, theme) {
  const all = [];
  for (let power = 10 ** Math.floor(Math.log10(from)); power <= to; power *= 10)
    for (const factor of [1, 2, 5]) if (factor * power >= from && factor * power <= to) all.push(factor * power);
  horizontalTicks(pen, box, all.map((value) => ({at: x(Math.log(value)), label: String(Number(value.toPrecision(1)))})), label, theme);
}

// Lines along the left and the bottom of the plot, and along zero.
function frame(pen, box, theme, zero) {
  const base = Math.round(box.y + box.height) + 0.5;
  pen.lines([[box.x, base, box.x + box.width, base]], theme.frame);
  if (zero > box.y && zero < base) pen.lines([[box.x, zero, box.x + box.width, zero]], theme.frame, 1, [4, 3]);
}

// Text cut to a width; the unit at its end is kept.
function shortened(words, width, size) {
  if (textWidth(words, size) <= width) return words;
  const [, name, unit = ''] = words.match(/^(.*?)( \([^()]*\))?$/s);
  let end = name.length;
  while (end > 1 && textWidth(`${name.slice(0, end)}…${unit}`, size) > width) --end;
  return `${name.slice(0, end)}…${unit}`;
}

// Text broken into lines of a width at its blanks.
function wrapped(text, width, size, weight = 400) {
  const lines = [''];
  for (const word of text.split(' ')) {
    const longer = `${lines.at(-1)} ${word}`.trim();
    if (lines.at(-1) && textWidth(longer, size, weight) > width) lines.push(word);
    else lines[lines.length - 1] = longer;
  }
  return lines;
}

// Marks and names in lines above the plot; returns their height. If buttons name the curves, the legend is
// empty. `mark` draws a mark; without it the mark is a line, or an area if `wide`.
function legend(pen, entries, left, right, theme) {
  if (theme.named) return 10;
  let x = left, y = 13;
  for (const {label, colour, dash, mark, wide, thickness = 2.5} of entries) {
    const lines = wrapped(label, right - left - 24, fontSize);
    const width = 24 + Math.max(...lines.map((line) => textWidth(line, fontSize)));
    if (x > left && x + width > right) { x = left; y += 17; }
    if (mark) mark(pen, x + 8, y - 4, colour, theme.paper);
    else if (wide) pen.rect(x, y - 10, 16, 12, colour, 0.3);
    else pen.lines([[x, y - 4, x + 16, y - 4]], colour, thickness, dash);
    lines.forEach((line, n) => pen.text(x + 21, y + 17 * n, line, {...small(theme), fill: theme.ink}));
    y += 17 * (lines.length - 1);
    x += width + 16;
  }
  return y + 9;
}

// Axis of the time of day; returns the time range as text.
function timeAxis(pen, box, x, samples, theme) {
  const [begin, end] = samples.view.map((position) => samples.at(position).time);
  const placed = timeTicks(samples, samples.view, box.width / 64).map(({place, label}) => ({at: x(place), label}));
  horizontalTicks(pen, box, placed, `UTC, ${day(begin)}${day(end) === day(begin) ? '' : ` to ${day(end)}`}`, theme);
  return `from ${clock(begin)} to ${clock(end)} UTC`;
}

// Writes the names of several flights above a plot over time, if they fit.
function nameFlights(pen, box, x, samples, above, theme) {
  if (samples.flights.length < 2) return;
  for (const {name, offset, duration} of samples.flights) {
    const left = Math.max(x(offset), box.x), right = Math.min(x(offset + duration), box.x + box.width);
    if (textWidth(name, fontSize) < right - left) pen.text(left + 2, box.y - above, name, small(theme));
  }
}

// Strokes along an interval with the dashes of its regime.
function dashes(pen, left, right, y, height, {colour, dash}, opacity) {
  const [mark, gap] = dash ?? [right - left, 0];
  for (let at = left; at < right; at += mark + gap) pen.rect(at, y, Math.min(mark, right - at), height, colour, opacity);
}

// Horizontal error bar with its caps.
function errorBar(pen, low, high, y, colour, width) {
  pen.lines([[low, y, high, y], ...[low, high].map((end) => [end, y - 4, end, y + 4])], colour, width);
}

// Prints the number of samples outside of the plot at its lower right.
function tellBeyond(pen, box, beyond, theme) {
  if (beyond > 0)
    pen.text(box.x + box.width - 4, box.y + box.height - 6, `${countText(beyond)} beyond the axis`,
      {...small(theme, 'end'), size: smallSize});
}
