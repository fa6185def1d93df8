// Simulated motions: poses and energies at some times, interpolated between them.

import { floats } from "./contents.js";
import { between } from "./rotation.js";

/** A motion of the body; lengths in the unit of the clouds as drawn. */
export class Run {
  constructor(fields, length) {
    this.start = fields.start; // the component it was pushed off, or null
    this.last = fields.last;
    this.ended = fields.ended; // where and how, in words
    for (const name of ["times", "quaternions", "offsets", "potential", "kinetic"]) {
      this[name] = floats(fields[name]);
    }
    this.scale = 2 ** fields.length_exponent / length;
    this.end = this.times[this.times.length - 1];
  }

  /** Pose and energies at a time. */
  at(time) {
    const { times } = this;
    let [low, high] = [0, times.length - 1];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (times[middle] <= time) low = middle;
      else high = middle;
    }
    const share = high > low ? clamp((time - times[low]) / (times[high] - times[low])) : 0;
    const mixed = (values, size = 1, k = 0) =>
      values[size * low + k] + share * (values[size * high + k] - values[size * low + k]);
    const quaternion = (i) => Array.from(this.quaternions.subarray(4 * i, 4 * i + 4));
    return {
      quaternion: between(quaternion(low), quaternion(high), share),
      offset: [0, 1, 2].map((k) => this.scale * mixed(this.offsets, 3, k)),
      potential: mixed(this.potential),
      kinetic: mixed(this.kinetic),
    };
  }
}

function clamp(share) {
  return Math.min(1, Math.max(0, share));
}
