// The charts below the scene; that of the energies has a file of its own.

import { drawing, figure, frame, label, path, svg } from "./svg.js";

const SPECTRUM_HEIGHT = 158;
const NAMED = 6; // pixels above the plane, for what its sides mean
const SAME = 1e-6; // of the largest: eigenvalues that are drawn as one
const DOT = 5; // pixels, the radius of an eigenvalue
const CLUSTER = 26; // pixels between dots that have no room for a number each
/** The twelve eigenvalues at an equilibrium in the complex plane. */
export function drawSpectrum(place, component) {
  const values = component.eigenvalues;
  if (!values) {
    note(place, "Double precision does not give them here, or the dynamics is not defined.");
    return;
  }
  const { width, height, bottom, ...area } = frame(place, SPECTRUM_HEIGHT);
  const top = area.top + NAMED;
  const most = Math.max(...values.flat().map(Math.abs)) || 1;
  const [middle, centre] = [width / 2, (top + bottom) / 2];
  const x = (re) => middle + (re / (1.15 * most)) * (width / 2 - 14);
  const y = (im) => centre - (im / (1.15 * most)) * (bottom - centre);
  const growing = values.filter(([re]) => re > 0).length;
  const half = { x: middle, y: top, width: width / 2 - 2, height: bottom - top };
  const end = { class: "tick", "text-anchor": "end" };
  const parts = [
    svg("rect", { ...half, class: "unstable" }),
    path([[2, centre], [width - 2, centre]], { class: "axis" }),
    path([[middle, top], [middle, bottom]], { class: "axis" }),
    label(8, top - 5, "a push decays", { class: "tick" }),
    label(width - 8, top - 5, "a push grows", end),
    label(width - 8, centre + 16, "real part", end),
    label(middle + 6, bottom - 6, "imaginary part", { class: "tick" }),
  ];
  const found = alike(values, SAME * most);
  for (const { re, im } of found) {
    const words = `${figure(re)} ${im < 0 ? "−" : "+"} ${figure(Math.abs(im))} i`;
    const title = svg("title", {}, words);
    const kind = re > 0 ? "mode growing" : "mode";
    parts.push(svg("circle", { cx: x(re), cy: y(im), r: DOT, class: kind }, title));
  }
  for (const { across, low, times } of clusters(found, x, y)) {
    const centred = { class: "tick count", "text-anchor": "middle" };
    if (times > 1) parts.push(label(across, low + 18, `×${times}`, centred));
  }
  const words = `${growing} of ${values.length} eigenvalues have a positive real part`;
  const key = document.createElement("p");
  key.className = "key";
  key.textContent = `${component.name}, index ${component.index}: ${words}.`;
  place.replaceChildren(drawing(width, bottom + 2, words, ...parts), key);
}

/** Eigenvalues that are drawn at one place, and how many they are. */
function alike(values, distance) {
  const found = [];
  for (const [re, im] of values) {
    const same = found.find((one) => Math.hypot(one.re - re, one.im - im) <= distance);
    if (same) same.times += 1;
    else found.push({ re, im, times: 1 });
  }
  return found;
}

/** Dots near one another, where the number below them stands, and of how many eigenvalues. */
function clusters(found, x, y) {
  const groups = [];
  for (const { re, im, times } of found) {
    const dot = { left: x(re), at: y(im), growing: re > 0 };
    const near = (other) =>
      other.growing === dot.growing && Math.hypot(other.left - dot.left, other.at - dot.at) < CLUSTER;
    const joined = groups.filter((group) => group.dots.some(near));
    for (const group of joined) groups.splice(groups.indexOf(group), 1);
    const dots = [dot, ...joined.flatMap((group) => group.dots)];
    groups.push({ dots, times: joined.reduce((sum, group) => sum + group.times, times) });
  }
  return groups.map(({ dots, times }) => ({
    across: (Math.min(...dots.map((dot) => dot.left)) + Math.max(...dots.map((dot) => dot.left))) / 2,
    low: Math.max(...dots.map((dot) => dot.at)),
    times,
  }));
}

/** The largest distances of pairs, as a list of bars. */
export function drawResiduals(place, clouds, { labels, fit, sampled }) {
  const rows = clouds.worst(8);
  const most = clouds.distances[rows[0]] || 1;
  const list = document.createElement("ol");
  list.className = "bars";
  for (const row of rows) {
    const entry = document.createElement("li");
    const name = document.createElement("bdi");
    name.textContent = labels && !sampled ? labels[row] : `${sampled ? "sample" : "row"} ${row}`;
    name.title = name.textContent;
    const bar = document.createElement("span");
    bar.className = "bar-line";
    bar.style.width = `${(100 * clouds.distances[row]) / most}%`;
    const track = document.createElement("span");
    track.append(bar);
    const value = document.createElement("span");
    value.className = "value";
    value.textContent = figure(clouds.distances[row], 5);
    entry.append(name, track, value);
    list.append(entry);
  }
  const key = document.createElement("p");
  key.className = "key";
  const others = clouds.n - rows.length;
  key.textContent = `RMSE of all ${clouds.n}${sampled ? " in the sample" : ""}: ${fit}${others > 0 ? `; ${others} more are smaller` : ""}.`;
  place.replaceChildren(list, key);
}

const LEAST = -5; // of the logarithm of a margin that has a place of its own

/** The margin on a logarithmic gauge from "not unique" to "clear". */
export function drawMargin(place, { relative, words }) {
  const { width, right } = frame(place, 0);
  const [start, zero, y] = [64, 14, 40];
  const x = (share) => start + (1 - Math.max(LEAST, Math.log10(share)) / LEAST) * (right - 16 - start);
  const zones = [[10 ** LEAST, 1e-3, "weak"], [1e-3, 1e-2, "fair"], [1e-2, 1, "clear"]];
  const parts = zones.map(([from, to, kind]) =>
    svg("rect", { x: x(from), y, width: x(to) - x(from), height: 16, class: `zone ${kind}` }),
  );
  parts.push(svg("rect", { x: zero, y, width: start - zero - 4, height: 16, class: "zone none" }));
  const ticks = { "0.1 %": 1e-3, "1 %": 1e-2, "100 %": 1 };
  for (const [text, share] of Object.entries(ticks)) {
    parts.push(label(x(share), y + 32, text, { class: "tick", "text-anchor": "middle" }));
  }
  parts.push(label((zero + start) / 2 - 2, y + 32, "0", { class: "tick", "text-anchor": "middle" }));
  const at = relative > 0 ? x(relative) : (zero + start) / 2 - 2;
  parts.push(svg("path", { d: `M${at} ${y - 3}l-7 -13h14z`, class: "needle" }));
  const key = document.createElement("p");
  key.className = "key";
  key.textContent = `${words[0].toUpperCase()}${words.slice(1)}.`;
  const meaning = document.createElement("p");
  meaning.className = "key";
  meaning.textContent =
    "Red: not unique. Brown: by a hair, and the noise may decide. Green: the farther right, the clearer.";
  place.replaceChildren(drawing(width, 84, words, ...parts), key, meaning);
}

/** Words where a chart would be. */
export function note(place, words) {
  const paragraph = document.createElement("p");
  paragraph.className = "key";
  paragraph.textContent = words;
  place.replaceChildren(paragraph);
}
