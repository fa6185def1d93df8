// The four charts beside the scene.

import { drawing, figure, label, path, steps, svg } from "./svg.js";

const WIDTH = 460;
const HEIGHT = 260;
const AREA = { left: 58, right: 446, top: 14, bottom: 222 };
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
    const values = {
      potential: run.potential,
      kinetic: run.kinetic,
      total: run.potential.map((value, i) => value + run.kinetic[i]),
    };
    const top = Math.max(...values.total, ...values.potential) || 1;
    const x = (time) => AREA.left + ((AREA.right - AREA.left) * time) / (run.end || 1);
    const y = (value) => AREA.bottom - ((AREA.bottom - AREA.top) * value) / (1.06 * top);
    this.x = x;
    const parts = [...axes(run.end, top * this.unit, x, (v) => y(v / this.unit))];
    for (const [level, name] of this.levels) {
      if (level === null || level > 1.06 * top) continue;
      parts.push(path([[AREA.left, y(level)], [AREA.right, y(level)]], { class: "level" }));
      const words = label(AREA.right, y(level) - 4, name, { class: "tick", "text-anchor": "end" });
      parts.push(words);
    }
    for (const [kind] of KINDS) {
      const points = Array.from(run.times, (time, i) => [x(time), y(values[kind][i])]);
      parts.push(path(points, { class: `line ${kind}` }));
    }
    this.cursor = svg("line", { y1: AREA.top, y2: AREA.bottom, class: "cursor" });
    const words = `Energies against time, from ${figure(this.unit * values.total[0])} to ${figure(
      this.unit * values.total.at(-1),
    )}`;
    this.box = drawing(WIDTH, HEIGHT, words, ...parts, this.cursor);
    this.box.addEventListener("pointerdown", (event) => this.#scrub(event));
    this.box.addEventListener("pointermove", (event) => event.buttons && this.#scrub(event));
    this.key = document.createElement("p");
    this.key.className = "key";
    this.place.replaceChildren(this.box, this.key);
  }

  #scrub(event) {
    const frame = this.box.getBoundingClientRect();
    const place = ((event.clientX - frame.left) / frame.width) * WIDTH;
    const share = (place - AREA.left) / (AREA.right - AREA.left);
    this.scrub(Math.min(1, Math.max(0, share)) * this.run.end);
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
        entry.textContent = `${name}: ${figure(this.unit * now[kind])}`;
        return entry;
      }),
    );
  }
}

function* axes(end, top, x, y) {
  const { left, right, bottom } = AREA;
  yield path([[left, bottom], [right, bottom]], { class: "axis" });
  for (const time of steps(end)) {
    yield label(x(time), bottom + 16, figure(time), { class: "tick", "text-anchor": "middle" });
  }
  yield label(right, bottom + 32, "time, in units of the springs", {
    class: "tick",
    "text-anchor": "end",
  });
  for (const value of steps(top)) {
    if (value) yield path([[left, y(value)], [right, y(value)]], { class: "grid" });
    yield label(left - 6, y(value) + 4, figure(value), { class: "tick", "text-anchor": "end" });
  }
}

/** The twelve eigenvalues at an equilibrium in the complex plane. */
export function drawSpectrum(place, component) {
  const values = component.eigenvalues;
  if (!values) {
    note(place, "Double precision does not give them here, or the dynamics is not defined.");
    return;
  }
  const size = Math.max(...values.flat().map(Math.abs)) * 1.15 || 1;
  const [middle, centre] = [WIDTH / 2, (AREA.top + AREA.bottom) / 2];
  const x = (re) => middle + (re / size) * (WIDTH / 2 - 14);
  const y = (im) => centre - (im / size) * (AREA.bottom - centre);
  const growing = values.filter(([re]) => re > 0).length;
  const parts = [
    svg("rect", {
      x: middle,
      y: AREA.top,
      width: WIDTH / 2 - 14,
      height: AREA.bottom - AREA.top,
      class: "unstable",
    }),
    path([[14, centre], [WIDTH - 14, centre]], { class: "axis" }),
    path([[middle, AREA.top], [middle, AREA.bottom]], { class: "axis" }),
    label(20, AREA.top + 14, "decays", { class: "tick" }),
    label(WIDTH - 20, AREA.top + 14, "grows", { class: "tick", "text-anchor": "end" }),
    label(WIDTH - 14, AREA.bottom + 16, `real part, to ±${figure(size, 3)}`, {
      class: "tick",
      "text-anchor": "end",
    }),
    ...values.map(([re, im]) =>
      svg(
        "circle",
        { cx: x(re), cy: y(im), r: 5, class: re > 0 ? "mode growing" : "mode" },
        svg("title", {}, `${figure(re)} ${im < 0 ? "−" : "+"} ${figure(Math.abs(im))} i`),
      ),
    ),
  ];
  const words = `${growing} of ${values.length} eigenvalues have a positive real part`;
  const key = document.createElement("p");
  key.className = "key";
  key.textContent = `${component.name}: ${words}.`;
  place.replaceChildren(drawing(WIDTH, HEIGHT - 14, words, ...parts), key);
}

/** The largest distances of pairs, as a list of bars. */
export function drawResiduals(place, clouds, labels, rmse) {
  const rows = clouds.worst(8);
  const most = clouds.distances[rows[0]] || 1;
  const list = document.createElement("ol");
  list.className = "bars";
  for (const row of rows) {
    const entry = document.createElement("li");
    const name = document.createElement("bdi");
    name.textContent = labels ? labels[row] : `row ${row}`;
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
  key.textContent = `RMSE of all ${clouds.n}: ${figure(rmse, 7)}${others > 0 ? `; ${others} more are smaller` : ""}.`;
  place.replaceChildren(list, key);
}

const LEAST = -5; // of the logarithm of a margin that has a place of its own

/** The margin on a logarithmic gauge from "not unique" to "clear". */
export function drawMargin(place, { relative, words }) {
  const x = (share) => {
    const power = Math.max(LEAST, Math.log10(share));
    return AREA.left + ((power - LEAST) / -LEAST) * (AREA.right - AREA.left);
  };
  const y = 46;
  const zones = [[10 ** LEAST, 1e-3, "weak"], [1e-3, 1e-2, "fair"], [1e-2, 1, "clear"]];
  const parts = zones.map(([from, to, kind]) =>
    svg("rect", { x: x(from), y, width: x(to) - x(from), height: 16, class: `zone ${kind}` }),
  );
  parts.push(svg("rect", { x: 14, y, width: AREA.left - 18, height: 16, class: "zone none" }));
  for (const [share, words_] of [[1e-5, "0.001 %"], [1e-3, "0.1 %"], [1e-2, "1 %"], [1, "100 %"]]) {
    parts.push(label(x(share), y + 34, words_, { class: "tick", "text-anchor": "middle" }));
  }
  parts.push(label(14, y + 34, "0", { class: "tick" }));
  const at = relative > 0 ? x(relative) : 14 + (AREA.left - 18) / 2;
  parts.push(svg("path", { d: `M${at} ${y - 3}l-7 -13h14z`, class: "needle" }));
  const key = document.createElement("p");
  key.className = "key";
  key.textContent = `${words[0].toUpperCase()}${words.slice(1)}.`;
  place.replaceChildren(drawing(WIDTH, 96, words, ...parts), key);
}

/** Words where a chart would be. */
export function note(place, words) {
  const paragraph = document.createElement("p");
  paragraph.className = "key";
  paragraph.textContent = words;
  place.replaceChildren(paragraph);
}
