'use strict';

// Samples of the report, and their selection.

function decode(text, Numbers) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = letters.charCodeAt(i);
  return new Numbers(bytes.buffer);
}

// Whole numbers, each stored as the difference from the previous one; a difference of zero is followed by a
// repeat count.
function unpacked(text) {
  const bytes = decode(text, Uint8Array), numbers = [];
  let at = 0, value = 0;
  const next = () => {
    let number = 0, factor = 1;
    for (; bytes[at] > 127; factor *= 128) number += (bytes[at++] - 128) * factor;
    return number + bytes[at++] * factor;
  };
  while (at < bytes.length) {
    const told = next();
    value += told % 2 ? -(told + 1) / 2 : told / 2;
    numbers.push(value);
    if (told === 0) for (let more = next(); more > 0; --more) numbers.push(value);
  }
  return numbers;
}

function decodeColumn({name, title, unit, least, step, values}) {
  const missing = 65535;
  const quantised = unpacked(values);
  const numbers = new Float64Array(quantised.length);
  for (let i = 0; i < numbers.length; ++i) numbers[i] = quantised[i] === missing ? NaN : least + quantised[i] * step;
  return {name, title, values: numbers, label: withUnit(title, unit), unit};
}

// First whole number in first ... last from which a condition holds; otherwise `last`.
function firstWhere(first, last, holds) {
  while (first < last) {
    const middle = (first + last) >> 1;
    if (holds(middle)) last = middle;
    else first = middle + 1;
  }
  return first;
}

const withUnit = (words, unit) => unit ? `${words} (${unit})` : words;

function median(numbers) {
  return numbers.slice().sort()[numbers.length >> 1];
}

// Flights follow one another on the time axis: `position` is in seconds along it, with gaps between flights.
class Samples {
  constructor(data) {
    this.columns = new Map(data.columns.map((column) => [column.name, decodeColumn(column)]));
    this.flights = [];
    const times = data.flights.map((flight) => {
      let sum = 0;
      return Float64Array.from(unpacked(flight.milliseconds), (step) => sum += step);
    });
    this.count = times.reduce((sum, flight) => sum + flight.length, 0);
    this.time = new Float64Array(this.count);
    this.position = new Float64Array(this.count);
    this.breaks = new Uint8Array(this.count);  // 1: not connected to the previous sample
    const room = 0.02 * times.reduce((sum, flight) => sum + flight[flight.length - 1] / 1000, 0);
    let i = 0, offset = 0;
    data.flights.forEach(({name, start}, number) => {
      const after = times[number];
      const steps = new Float64Array(after.length - 1);
      for (let j = 0; j < steps.length; ++j) steps[j] = after[j + 1] - after[j];
      const longest = steps.length ? 3 * median(steps) : 0;
      const flight = {name, start, offset, first: i, duration: after[after.length - 1] / 1000};
      for (let j = 0; j < after.length; ++j, ++i) {
        this.time[i] = start + after[j] / 1000;
        this.position[i] = offset + after[j] / 1000;
        this.breaks[i] = j === 0 || steps[j - 1] > longest ? 1 : 0;
      }
      flight.end = i;
      this.flights.push(flight);
      offset += flight.duration + room;
    });
    this.length = Math.max(offset - room, 1e-3);
    this.every = new Uint8Array(this.count).fill(1);
    this.setIntervals(data.intervals);
    this.clear();
  }

  setIntervals(intervals) {
    this.intervals = [];  // positions on the time axis, once for each flight that they meet
    this.regimes = new Map();  // map from name to its samples, 1 or 0
    for (const {name, begin, end} of intervals) {
      if (!this.regimes.has(name)) this.regimes.set(name, new Uint8Array(this.count));
      for (const flight of this.flights) {
        const from = Math.max(begin - flight.start, 0), to = Math.min(end - flight.start, flight.duration);
        if (to < from) continue;
        this.shade(name, flight.offset + from, flight.offset + to);
        for (let i = flight.first; i < flight.end; ++i)
          if (this.time[i] >= begin && this.time[i] < end) this.regimes.get(name)[i] = 1;
      }
    }
  }

  // Adds an interval, joined with an overlapping interval of its regime: flights may cover the same time.
  shade(name, begin, end) {
    const known = this.intervals.find((one) => one.name === name && one.begin <= end && one.end >= begin);
    if (!known) this.intervals.push({name, begin, end});
    else Object.assign(known, {begin: Math.min(known.begin, begin), end: Math.max(known.end, end)});
  }

  // Flight and time (s since 1970) at a position on the time axis.
  at(position) {
    const flight = this.flights.findLast(({offset}) => offset <= position) ?? this.flights[0];
    return {flight, time: flight.start + Math.min(Math.max(position - flight.offset, 0), flight.duration)};
  }

  get view() { return this.range ?? [0, this.length]; }

  // Selects by position on the time axis and by names of intervals; null and an empty set select all.
  choose(range, names = new Set()) {
    this.range = range;
    this.names = names;
    this.selected = this.every.slice();
    if (names.size) {
      this.selected.fill(0);
      for (const name of names) this.regimes.get(name).forEach((inside, i) => { this.selected[i] |= inside; });
    }
    if (range)
      this.position.forEach((p, i) => { if (p < range[0] || p > range[1]) this.selected[i] = 0; });
    this.selectedCount = countOf(this.selected);
  }

  clear() { this.choose(null); }

  // Sample nearest to a position on the time axis.
  nearest(position) {
    const low = firstWhere(0, this.count - 1, (i) => this.position[i] >= position);
    return low > 0 && position - this.position[low - 1] < this.position[low] - position ? low - 1 : low;
  }

  // Names of intervals with masks of their selected samples, and of all selected samples.
  get selectedByRegime() {
    const masks = [...this.regimes].map(([name, inside]) => [name, this.selected.map((one, i) => one & inside[i])]);
    return [...masks, ['All', this.selected]];
  }

  get isFiltered() { return this.range !== null || this.names.size > 0; }

  // Indices of the selected samples that have a value in all the columns.
  indices(columns, mask = this.selected) {
    const found = [];
    const all = columns.map(({values}) => values);
    for (let i = 0; i < this.count; ++i) {
      let has = mask[i] === 1;
      for (let c = 0; has && c < all.length; ++c) has = !Number.isNaN(all[c][i]);
      if (has) found.push(i);
    }
    return found;
  }
}

// Number of ones in a mask.
const countOf = (mask) => mask.reduce((count, one) => count + one, 0);

function statistics(values, indices) {
  let least = Infinity, greatest = -Infinity, sum = 0, squares = 0;
  for (const i of indices) {
    const value = values[i];
    least = Math.min(least, value);
    greatest = Math.max(greatest, value);
    sum += value;
    squares += value * value;
  }
  const count = indices.length;
  return {count, least, greatest, mean: sum / count, rms: Math.sqrt(squares / count)};
}
