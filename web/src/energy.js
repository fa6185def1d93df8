// The energies of a run against time.

import { drawing, figure, frame, label, path, steps, svg } from "./svg.js";

const HEIGHT = 260;
const NAMED = 4; // pixels, for what the axis is of
const LETTER = 7; // pixels, of a name; most are narrower
const APART = 17; // pixels from a level to the next that has a name of its own
const FLOOR = 1e-9; // of the largest energy: less is drawn at the foot of a logarithmic axis
const KINDS = [
  ["total", "V, all of it"],
  ["potential", "V_p, in the springs"],
  ["kinetic", "V_k, in the motion"],
];

/** Energies of a run against time, the levels of the equilibria, and a cursor that follows. */
export class EnergyChart {
  constructor(place, { levels, unit, scrub }) {
    Object.assign(this, { place, levels, unit, scrub });
  }

  draw(run) {
    this.run = run;
    this.area = frame(this.place, HEIGHT);
    this.area.top += NAMED;
    const { left, right, top, bottom, width, height } = this.area;
    const values = {
      potential: run.potential,
      kinetic: run.kinetic,
      total: run.potential.map((value, i) => value + run.kinetic[i]),
    };
    const most = Math.max(...values.total) || 1;
    const x = (time) => left + ((right - left) * time) / (run.end || 1);
    this.x = x;
    const scale = this.#scale(most, values.total.at(-1));
    const { y, levels } = scale;
    const parts = [...axes(this.area, run.end, x, scale, this.unit)];
    for (const { height: at } of levels.flat()) {
      parts.push(path([[left, at], [right, at]], { class: "level" }));
    }
    for (const [kind] of KINDS) {
      const points = Array.from(run.times, (time, i) => [x(time), y(values[kind][i])]);
      parts.push(path(points, { class: `line ${kind}` }));
    }
    for (const group of levels) {
      const end = { class: "tick halo level-name", "text-anchor": "end" };
      parts.push(label(right, group[0].height - 4, levelWords(group, right - left), end));
    }
    this.cursor = svg("line", { y1: top, y2: bottom, class: "cursor" });
    const [first, last] = [values.total[0], values.total.at(-1)].map((v) => figure(this.unit * v));
    const words = `Energies against time; all of it falls from ${first} to ${last}`;
    this.box = drawing(width, height, words, ...parts, this.cursor);
    this.box.addEventListener("pointerdown", (event) => this.#scrub(event));
    this.box.addEventListener("pointermove", (event) => event.buttons && this.#scrub(event));
    this.key = document.createElement("p");
    this.key.className = "key";
    this.place.replaceChildren(this.box, this.key);
  }

  /** An axis on which levels keep apart: linear, or logarithmic where more of them do so there. */
  #scale(most, last) {
    const shown = this.levels.filter(({ level }) => level !== null && level <= 1.06 * most);
    const { top, bottom } = this.area;
    const straight = (value) => bottom - ((bottom - top) * value) / (1.06 * most);
    const linear = { y: straight, levels: grouped(shown, straight), ticks: (unit) => steps(most * unit) };
    const least = Math.min(...[...shown.map(({ level }) => level), last].filter((value) => value > 0));
    const floor = Math.max(least, FLOOR * most) / 3;
    if (!(floor > 0 && floor < most)) return linear;
    const span = Math.log(1.3 * most / floor);
    const curved = (value) => bottom - ((bottom - top) * Math.log(Math.max(value, floor) / floor)) / span;
    const logarithmic = {
      y: curved,
      levels: grouped(shown, curved),
      ticks: (unit) => powers(floor * unit, 1.3 * most * unit),
      floor,
    };
    return logarithmic.levels.length > linear.levels.length ? logarithmic : linear;
  }

  #scrub(event) {
    const box = this.box.getBoundingClientRect();
    const { width, left, right } = this.area;
    const place = ((event.clientX - box.left) / box.width) * width;
    this.scrub(Math.min(1, Math.max(0, (place - left) / (right - left))) * this.run.end);
  }

  /** Moves the cursor; without a time there is none. */
  follow(time) {
    this.cursor.setAttribute("visibility", time === null ? "hidden" : "visible");
    const at = this.run.at(time ?? this.run.end);
    if (time !== null) {
      this.cursor.setAttribute("x1", this.x(time));
      this.cursor.setAttribute("x2", this.x(time));
    }
    const now = { ...at, total: at.potential + at.kinetic };
    this.key.replaceChildren(
      ...KINDS.map(([kind, name]) => {
        const entry = document.createElement("span");
        entry.className = `entry ${kind}`;
        entry.textContent = time === null ? name : `${name}: ${figure(this.unit * now[kind])}`;
        return entry;
      }),
    );
  }
}

/** The names of levels that are next to one another, from the top; where room is scarce, indices. */
function levelWords(group, width) {
  const words = group.map(({ name, index }) => `${name} (${index})`).join(" · ");
  if (group.length === 1 || words.length * LETTER <= width) return words;
  return `index ${group.map(({ index }) => index).join(" · ")}`;
}

function* axes({ left, right, bottom }, end, x, { y, ticks, floor }, unit) {
  yield path([[left, bottom], [right, bottom]], { class: "axis" });
  for (const time of steps(end)) {
    yield label(x(time), bottom + 16, figure(time), { class: "tick", "text-anchor": "middle" });
  }
  yield label(2, 10, floor ? "energy on a logarithmic axis" : "energy", { class: "tick" });
  yield label(right, bottom + 32, "time in units of the springs", { class: "tick", "text-anchor": "end" });
  for (const value of ticks(unit)) {
    const at = y(value / unit);
    if (at < bottom) yield path([[left, at], [right, at]], { class: "grid" });
    const short = floor && !(value < 1e5 && value > 1e-4);
    const words = short ? value.toExponential(0).replace("+", "") : figure(value);
    yield label(left - 6, at + 4, words, { class: "tick", "text-anchor": "end" });
  }
}

/** Levels from the top, those without room for two names together. */
function grouped(levels, y) {
  const placed = levels.map((one) => ({ ...one, height: y(one.level) }));
  const groups = [];
  for (const one of placed.sort((a, b) => a.height - b.height || b.index - a.index)) {
    const group = groups.at(-1);
    if (group && one.height - group.at(-1).height < APART) group.push(one);
    else groups.push([one]);
  }
  return groups;
}

/** Powers of ten between two numbers, about five of them. */
function powers(from, to) {
  const [first, last] = [Math.ceil(Math.log10(from)), Math.floor(Math.log10(to))];
  const step = Math.max(1, Math.ceil((last - first) / 5));
  const found = [];
  for (let k = first; k <= last; k += step) found.push(10 ** k);
  return found;
}
