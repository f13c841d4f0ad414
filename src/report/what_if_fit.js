// Least squares of a what-if from the sums that the report keeps, independent of the page. A coefficient is
// its number; values are changes from the start, at which the residual equals its column.

const leastPivot = 1e-11;  // relative pivot of a column after the previous ones; a smaller one means
                           // collinear

// Sums of products of (columns, residual), restored from their lower triangle.
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

// Symmetric matrix as L L', with equal scaling of the unknowns. Collinear ones are excluded: their pivot is
// zero.
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

  // Rows of the inverse.
  get inverse() {
    return this.lower.map((row, i) => this.solve(row.map((_, j) => j === i ? 1 : 0)));
  }
}

// Residual sum of squares with these values.
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

  // Weights of the residual noise with these effects in the model: findings among them, or replaced by
  // others, as many as there are weights for.
  weightsOf(on) {
    const taken = new Set([...on].map((effect) => this.effects[effect].standsFor).filter((effect) => effect !== null));
    const fitting = this.weights.filter((each) => each.taken.every((effect) => taken.has(effect)));
    return fitting.reduce((a, b) => b.taken.length > a.taken.length ? b : a);
  }

  // Numbers of the identifiable coefficients of an effect.
  coefficientsOf(effect) {
    const {first, count} = this.effects[effect];
    return Array.from({length: count}, (_, k) => first + k).filter((c) => !this.coefficients[c].fixed);
  }

  // Values that minimize the squares of some sums; `free` marks the unknowns.
  solved(sums, free, values) {
    const {matrix} = sums, last = values.length;
    const fixed = values.map((value, c) => free.includes(c) ? 0 : value);
    const right = free.map((c) => matrix[c][last] - matrix[c].reduce((sum, value, j) => j < last ? sum + value * fixed[j] : sum, 0));
    const factor = new Cholesky(free.map((a) => free.map((b) => matrix[a][b])));
    const found = factor.solve(right);
    free.forEach((c, k) => { fixed[c] = found[k]; });
    return {values: fixed, factor};
  }

  // Fits with some effects in the model. @param byHand a Map of coefficients to fixed values
  // @param own the model's coefficients are fitted again; @param weights as returned by `weightsOf`
  // @param bounded only to physical values
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
    // A coefficient beyond its bound is fixed there, until the others release it.
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

  // Half of the derivative of the squares with respect to a coefficient.
  slope({whole}, c, values) {
    const row = whole.matrix[c];
    return values.reduce((sum, value, j) => sum + row[j] * value, -row[values.length]);
  }

  least(c) { return (this.coefficients[c].minimum ?? -Infinity) - this.coefficients[c].start; }

  greatest(c) { return (this.coefficients[c].maximum ?? Infinity) - this.coefficients[c].start; }

  isAtBound(c, values) { return values[c] <= this.least(c) || values[c] >= this.greatest(c); }

  // Value of a coefficient, limited to its physical bounds.
  possible(c, value) {
    const {minimum, maximum} = this.coefficients[c];
    return Math.min(Math.max(value, minimum ?? -Infinity), maximum ?? Infinity);
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

  // Rms on unused samples: on the hold-out, otherwise on parts of the flights excluded one at a time.
  heldOutRms({values, free, weights}) {
    if (this.heldOut) return rmsLeft(this.heldOut, values);
    if (this.alike.filter(({samples}) => samples).length < 2) return NaN;  // the excluded part would be the
                                                                           // whole
    let squares = 0, samples = 0;
    weights.parts.forEach((part, k) => {
      if (!this.alike[k].samples) return;
      const {values: found} = this.solved(combined(weights.whole, part, -1), free, values);
      squares += squaresLeft(this.alike[k], found);
      samples += this.alike[k].samples;
    });
    return Math.sqrt(Math.max(squares, 0) / samples);
  }

  // Decrease of chi2 by additional effects, in units of the residual noise with all of them.
  fall(before, after, byHand, own) {
    const weights = this.weightsOf(after);
    const without = this.fit(before, byHand, own, weights), now = this.fit(after, byHand, own, weights);
    return this.gain(without, now, after.filter((effect) => !before.includes(effect)));
  }

  // Decrease of chi2 from one fit to another of the same weights, by additional effects, in units of the
  // autocorrelated noise. For one coefficient it is the square of its value over its error; for several, the
  // decrease of the squares over its mean by noise alone, times their number.
  gain(without, {squares, weights}, effects) {
    const added = effects.flatMap((effect) => this.coefficientsOf(effect));
    const before = this.byNoise(weights, without.free);
    const after = this.byNoise(weights, [...without.free, ...added]);
    const mean = (after.squares - before.squares) / (after.count - before.count);
    return mean > 0 ? (without.squares - squares) / mean : 0;
  }

  // Mean decrease of the squares by a fit of some coefficients to noise alone, and the number of those that
  // the flights determine.
  byNoise({scores, whole}, free) {
    const part = (matrix) => free.map((a) => free.map((b) => matrix[a][b]));
    const factor = new Cholesky(part(whole.matrix));
    return {squares: part(scores).reduce((sum, row, i) => sum + factor.solve(row)[i], 0),
            count: factor.lower.filter((row, i) => row[i] > 0).length};
  }
}
