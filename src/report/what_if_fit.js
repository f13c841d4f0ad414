// The arithmetic of a what-if: least squares by the sums that the report keeps, without a page. A coefficient is
// its number; values are changes from the start, at which the residual is as its column has it.

const leastPivot = 1e-11;  // of a column, beside those before it: less is what they imitate

// Sums of products of (columns, residual), whole again from their lower triangle.
function wholeSums({products, samples}, width) {
  const lower = decode(products, Float64Array);
  const matrix = Array.from({length: width}, () => new Float64Array(width));
  for (let i = 0, n = 0; i < width; ++i)
    for (let j = 0; j <= i; ++j, ++n) matrix[i][j] = matrix[j][i] = lower[n];
  return {matrix, samples};
}

function combined(a, b, sign = 1) {
  return {matrix: a.matrix.map((row, i) => row.map((value, j) => value + sign * b.matrix[i][j])),
          samples: a.samples + sign * b.samples};
}

// A symmetric matrix as L L', unknowns scaled alike. Those that others imitate stay out: their pivot is zero.
class Cholesky {
  constructor(matrix) {
    this.scale = matrix.map((row, i) => row[i] > 0 ? 1 / Math.sqrt(row[i]) : 0);
    this.lower = matrix.map((row) => new Float64Array(row.length));
    const {lower, scale} = this;
    for (let i = 0; i < matrix.length; ++i)
      for (let j = 0; j <= i; ++j) {
        let sum = scale[i] * scale[j] * matrix[i][j];
        for (let k = 0; k < j; ++k) sum -= lower[i][k] * lower[j][k];
        if (i === j) lower[i][i] = sum > leastPivot ? Math.sqrt(sum) : 0;
        else lower[i][j] = lower[j][j] ? sum / lower[j][j] : 0;
      }
  }

  solve(right) {
    const {lower, scale} = this, size = right.length;
    const x = Float64Array.from(right, (value, i) => value * scale[i]);
    for (let i = 0; i < size; ++i) {
      for (let k = 0; k < i; ++k) x[i] -= lower[i][k] * x[k];
      x[i] = lower[i][i] ? x[i] / lower[i][i] : 0;
    }
    for (let i = size - 1; i >= 0; --i) {
      for (let k = i + 1; k < size; ++k) x[i] -= lower[k][i] * x[k];
      x[i] = lower[i][i] ? x[i] / lower[i][i] : 0;
    }
    return x.map((value, i) => value * scale[i]);
  }

  // The rows of the inverse.
  get inverse() {
    return this.lower.map((row, i) => this.solve(row.map((_, j) => j === i ? 1 : 0)));
  }
}

// What is left of the squares with these values.
function squaresLeft({matrix}, values) {
  const change = [...values].map((value) => -value);
  change.push(1);
  return matrix.reduce((sum, row, i) =>
    sum + change[i] * row.reduce((product, value, j) => product + value * change[j], 0), 0);
}

const rmsLeft = (sums, values) => Math.sqrt(Math.max(squaresLeft(sums, values), 0) / sums.samples);

class WhatIfFit {
  constructor({coefficients, own, effects, weights, alike, outliers, heldOut}) {
    Object.assign(this, {coefficients, own, effects});
    const width = coefficients.length + 1;
    this.weights = weights.map(({effects: taken, parts, scores: covariance}) => {
      const each = parts.map((sums) => wholeSums(sums, width));
      const scores = wholeSums(covariance, width - 1).matrix;
      return {taken, scores, parts: each, whole: each.reduce((a, b) => combined(a, b))};
    });
    this.alike = alike.map((sums) => wholeSums(sums, width));
    this.all = [...this.alike, wholeSums(outliers, width)].reduce((a, b) => combined(a, b));
    this.heldOut = heldOut.samples ? wholeSums(heldOut, width) : null;
  }

  // The weights of the noise that is left with these effects in the model: of what was found and is among them, or
  // has another in its place, as many as there are weights for.
  weightsOf(on) {
    const taken = new Set([...on].map((effect) => this.effects[effect].standsFor).filter((effect) => effect !== null));
    const fitting = this.weights.filter((each) => each.taken.every((effect) => taken.has(effect)));
    return fitting.reduce((a, b) => b.taken.length > a.taken.length ? b : a);
  }

  // The numbers of the coefficients of an effect that the flights tell.
  coefficientsOf(effect) {
    const {first, count} = this.effects[effect];
    return Array.from({length: count}, (_, k) => first + k).filter((c) => !this.coefficients[c].fixed);
  }

  // The values that leave least by some sums, where `free` says which are looked for.
  solved(sums, free, values) {
    const {matrix} = sums, last = values.length;
    const fixed = values.map((value, c) => free.includes(c) ? 0 : value);
    const right = free.map((c) => matrix[c][last] - matrix[c].reduce((sum, value, j) => j < last ? sum + value * fixed[j] : sum, 0));
    const factor = new Cholesky(free.map((a) => free.map((b) => matrix[a][b])));
    const found = factor.solve(right);
    free.forEach((c, k) => { fixed[c] = found[k]; });
    return {values: fixed, factor};
  }

  // Fits with some effects in the model. @param byHand a Map of coefficients to values that are held
  // @param own the model's own coefficients are fitted again; @param weights as of `weightsOf`
  // @param bounded only to values that physics allows
  fit(on, byHand = new Map(), own = true, weights = this.weightsOf(on), bounded = true) {
    const {coefficients} = this;
    const values = Float64Array.from(coefficients, ({given, start}) => given - start);
    const free = [];
    if (own) for (let c = 0; c < this.own; ++c) if (!coefficients[c].fixed) free.push(c);
    for (const effect of on)
      for (const c of this.coefficientsOf(effect)) {
        if (byHand.has(c)) values[c] = byHand.get(c) - coefficients[c].start;
        else free.push(c);
      }
    // A coefficient that would go beyond its bound stays there, until the others let it go.
    const atBound = [];
    for (let step = 0;; ++step) {
      const {values: found, factor} = this.solved(weights.whole, free, values);
      const beyond = bounded ? free.find((c) => found[c] < this.least(c) || found[c] > this.greatest(c)) : undefined;
      if (beyond !== undefined) {
        values[beyond] = found[beyond] < this.least(beyond) ? this.least(beyond) : this.greatest(beyond);
        atBound.push(...free.splice(free.indexOf(beyond), 1));
        continue;
      }
      const freed = atBound.find((c) => this.slope(weights, c, found) * (found[c] === this.least(c) ? 1 : -1) < 0);
      if (freed === undefined || step > 4 * this.coefficients.length) return this.told(found, free, factor, weights);
      free.push(...atBound.splice(atBound.indexOf(freed), 1));
    }
  }

  // Half of what the squares grow by with a coefficient.
  slope({whole}, c, values) {
    const row = whole.matrix[c];
    return values.reduce((sum, value, j) => sum + row[j] * value, -row[values.length]);
  }

  least(c) { return (this.coefficients[c].least ?? -Infinity) - this.coefficients[c].start; }

  greatest(c) { return (this.coefficients[c].greatest ?? Infinity) - this.coefficients[c].start; }

  isAtBound(c, values) { return values[c] <= this.least(c) || values[c] >= this.greatest(c); }

  // A value of a coefficient, or the bound of physics that it is beyond.
  possible(c, value) {
    const {least, greatest} = this.coefficients[c];
    return Math.min(Math.max(value, least ?? -Infinity), greatest ?? Infinity);
  }

  told(values, free, factor, weights) {
    const squares = squaresLeft(weights.whole, values);
    const errors = new Float64Array(values.length);
    factor.inverse.forEach((row, k) => {
      const square = row.reduce((sum, a, i) => sum + row.reduce((product, b, j) =>
        product + a * weights.scores[free[i]][free[j]] * b, 0), 0);
      errors[free[k]] = Math.sqrt(Math.max(square, 0));
    });
    return {values, errors, free, weights, squares, rms: rmsLeft(this.all, values)};
  }

  // The rms on what took no part: on what is held out, else on parts of the flights left out in turn.
  heldOutRms({values, free, weights}) {
    if (this.heldOut) return rmsLeft(this.heldOut, values);
    if (this.alike.filter(({samples}) => samples).length < 2) return NaN;  // what is left out would be all
    let squares = 0, samples = 0;
    weights.parts.forEach((part, k) => {
      if (!this.alike[k].samples) return;
      const {values: found} = this.solved(combined(weights.whole, part, -1), free, values);
      squares += squaresLeft(this.alike[k], found);
      samples += this.alike[k].samples;
    });
    return Math.sqrt(Math.max(squares, 0) / samples);
  }

  // By how much chi2 falls with some effects more, in units of the noise that is left with all of them.
  fall(before, after, byHand, own) {
    const weights = this.weightsOf(after);
    const without = this.fit(before, byHand, own, weights), now = this.fit(after, byHand, own, weights);
    return this.gain(without, now, after.filter((effect) => !before.includes(effect)));
  }

  // By how much chi2 falls from one fit to another of the same weights, with some effects more, in units of the noise
  // with its memory: the mean of the scores of the effects, or where none is added of the coefficients that were fitted.
  gain(without, {squares, weights: {scores, whole}}, effects) {
    const added = effects.flatMap((effect) => [...this.coefficientsOf(effect)]);
    const told = (added.length ? added : without.free).filter((c) => whole.matrix[c][c] > 0);
    const variance = told.reduce((sum, c) => sum + scores[c][c] / whole.matrix[c][c], 0) / told.length;
    return variance > 0 ? (without.squares - squares) / variance : 0;
  }

  // How alike two changes are in units of the noise that is left with all that was found, -1 to 1.
  correlation(a, b) {
    const {matrix} = this.weights.at(-1).whole;
    const product = (x, y) => x.reduce((sum, value, i) =>
      sum + value * y.reduce((inner, other, j) => inner + matrix[i][j] * other, 0), 0);
    return product(a, b) / Math.sqrt(product(a, a) * product(b, b));
  }
}
