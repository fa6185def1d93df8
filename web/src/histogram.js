// How many pairs are how far apart, in the colours of the scene.

import { drawing, figure, frame, label, path, svg } from "./svg.js";
import { mixed, ramp } from "./ramp.js";

const HEIGHT = 104;
const BINS = 24;
const LEAST = 2; // pixels, of a bin that is not empty
const LETTER = 6.5; // pixels
const MARKED = 16; // pixels above the bars, for the mark of the RMSE and its words

/** The distances last measured, from 0 to the largest; fit: their RMSE in words, most: the end of the colours. */
export function drawHistogram(place, clouds, { rmse, fit, most }) {
  const { width } = frame(place, HEIGHT);
  const [left, right, top, bottom] = [4, width - 4, MARKED, HEIGHT - 18];
  const largest = clouds.largest;
  const counts = new Array(BINS).fill(0);
  for (const distance of clouds.distances) {
    counts[largest > 0 ? Math.min(BINS - 1, Math.floor((BINS * distance) / largest)) : 0] += 1;
  }
  const [fullest, stops] = [Math.max(...counts), ramp(place)];
  const step = (right - left) / BINS;
  const parts = counts.map((count, k) => {
    const height = count ? Math.max(LEAST, ((bottom - top) * count) / fullest) : 0;
    const fill = mixed(stops, most > 0 ? ((k + 0.5) * largest) / BINS / most : 0);
    const bar = { x: left + k * step + 0.5, y: bottom - height, width: step - 1, height, fill, class: "bin" };
    return svg("rect", bar, svg("title", {}, `${count} of ${clouds.n}`));
  });
  const at = largest > 0 ? left + ((right - left) * rmse) / largest : left;
  const words = `RMSE ${fit}`;
  const ends = at + 4 + LETTER * words.length > right;
  parts.push(
    path([[left, bottom], [right, bottom]], { class: "axis" }),
    path([[at, 3], [at, bottom]], { class: "cursor under" }),
    path([[at, 3], [at, bottom]], { class: "cursor" }),
    label(ends ? at - 4 : at + 4, top - 4, words, { class: "tick", "text-anchor": ends ? "end" : "start" }),
    label(left, bottom + 14, "0", { class: "tick" }),
    label(right, bottom + 14, figure(largest, 4), { class: "tick", "text-anchor": "end" }),
    label((left + right) / 2, bottom + 14, "distance of a pair", { class: "tick", "text-anchor": "middle" }),
  );
  const told = `Histogram of ${clouds.n} distances, from 0 to ${figure(largest, 4)}; ${words}`;
  place.replaceChildren(drawing(width, HEIGHT, told, ...parts));
}
