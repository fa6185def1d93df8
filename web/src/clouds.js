// Both clouds about their weighted means, in a unit of length in which the larger has radius 1.

/** Doubles source, target, weights, one after the other. */
export class Clouds {
  constructor(bytes) {
    const doubles = new Float64Array(bytes.buffer, bytes.byteOffset, bytes.byteLength / 8);
    const n = doubles.length / 7;
    const weights = doubles.slice(6 * n);
    const heaviest = largest(weights) || 1;
    this.n = n;
    this.weights = weights.map((w) => w / heaviest);
    this.mass = this.weights.reduce((sum, w) => sum + w, 0);
    const parts = [doubles.slice(0, 3 * n), doubles.slice(3 * n, 6 * n)];
    const size = Math.max(...parts.map(largest)) || 1;
    for (const part of parts) this.#centre(part, size);
    const radius = Math.max(...parts.map(reach)) || 1;
    for (const part of parts) for (let i = 0; i < part.length; i += 1) part[i] /= radius;
    [this.source, this.target] = parts;
    this.length = size * radius; // one unit here, in the unit of the data
    this.distances = new Float64Array(n);
  }

  /** Divides by a size and subtracts the mean, twice: the second time what rounding left of it. */
  #centre(points, size) {
    for (let i = 0; i < points.length; i += 1) points[i] /= size;
    for (let pass = 0; pass < 2; pass += 1) {
      for (let k = 0; k < 3; k += 1) {
        let sum = 0;
        for (let i = 0; i < this.n; i += 1) sum += this.weights[i] * points[3 * i + k];
        const mean = sum / this.mass;
        for (let i = 0; i < this.n; i += 1) points[3 * i + k] -= mean;
      }
    }
  }

  /** Distances of the pairs at a pose, and their weighted root mean square, in the data's unit. */
  measure(R, c) {
    const { source: x, target: y, weights, distances, length } = this;
    let sum = 0;
    for (let i = 0; i < this.n; i += 1) {
      const [a, b, d] = [x[3 * i], x[3 * i + 1], x[3 * i + 2]];
      const u = y[3 * i] - R[0] * a - R[1] * b - R[2] * d - c[0];
      const v = y[3 * i + 1] - R[3] * a - R[4] * b - R[5] * d - c[1];
      const w = y[3 * i + 2] - R[6] * a - R[7] * b - R[8] * d - c[2];
      const square = u * u + v * v + w * w;
      sum += weights[i] * square;
      distances[i] = length * Math.sqrt(square);
    }
    return length * Math.sqrt(sum / this.mass);
  }

  /** The largest distance last measured. */
  get largest() {
    return largest(this.distances);
  }

  /** The rows of the largest distances last measured, largest first. */
  worst(count) {
    const rows = [];
    for (let i = 0; i < this.n; i += 1) {
      const here = this.distances[i];
      if (rows.length === count && here <= this.distances[rows[count - 1]]) continue;
      let place = rows.length;
      while (place > 0 && this.distances[rows[place - 1]] < here) place -= 1;
      rows.splice(place, 0, i);
      if (rows.length > count) rows.pop();
    }
    return rows;
  }

  /** Evenly chosen rows, at most so many. */
  rows(most) {
    const step = Math.ceil(this.n / most);
    return Array.from({ length: Math.ceil(this.n / step) }, (_, i) => i * step);
  }
}

function largest(values) {
  return values.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
}

function reach(points) {
  let most = 0;
  for (let i = 0; i < points.length; i += 3) {
    most = Math.max(most, Math.hypot(points[i], points[i + 1], points[i + 2]));
  }
  return most;
}
