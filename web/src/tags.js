// Names of points, over the scene: none covers another or a point; the pairs farthest apart come first.

import { path, svg } from "./svg.js";

const ROOM = 9; // pixels from a point to its name
const ROOMS = [ROOM, 30, 60, 95]; // and farther off, at the end of a line
const SIDES = [[1, -1], [1, 1], [-1, -1], [-1, 1], [1, 0], [-1, 0], [0, -1], [0, 1]]; // right and down
const NEAR = 7; // pixels, of a point that a name would touch
const COVERED = 150; // points of each cloud that are kept in sight
const SAME = 14; // pixels: of a pair that is drawn at one place only one point is named
const LONGEST = 12; // letters

/** named: pairs of a row and its name; none where the scene cannot be drawn. */
export class Tags {
  constructor(stage, clouds, named) {
    Object.assign(this, { stage, clouds, lines: svg("svg"), rows: clouds.rows(COVERED) });
    document.getElementById("tags").append(this.lines);
    this.pairs = named.map(([row, words]) => ({ row, made: ["target", "source"].map((cloud) => tag(cloud, words)) }));
  }

  draw() {
    const { stage, clouds, pairs } = this;
    const seen = (row) => [stage.seen(clouds.target, row, false), stage.seen(clouds.source, row, true)];
    const shown = pairs.map(({ row, made }) => ({ made, at: seen(row), far: clouds.distances[row] }));
    shown.sort((one, other) => other.far - one.far);
    const taken = [...covers(stage.canvas), ...shown.flatMap(({ at }) => at.map(around))];
    const points = shown.length ? this.rows.flatMap(seen) : [];
    const size = [stage.canvas.clientWidth, stage.canvas.clientHeight];
    const lines = [];
    for (const { made, at } of shown) {
      const apart = Math.hypot(at[0][0] - at[1][0], at[0][1] - at[1][1]) > SAME;
      made.forEach((node, cloud) => {
        const [x, y] = at[cloud];
        node.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
        const free = cloud && !apart ? null : place(node, at[cloud], { taken, points, size });
        node.style.visibility = free ? "visible" : "hidden";
        if (!free) return;
        taken.push(free.box);
        node.style.left = `${free.left}px`;
        node.style.top = `${free.top}px`;
        if (free.line) lines.push(path([at[cloud], free.line], { class: "lead-line" }));
      });
    }
    this.lines.replaceChildren(...lines);
  }
}

function tag(cloud, words) {
  const node = document.createElement("bdi");
  node.className = `tag ${cloud}`;
  node.textContent = words.length > LONGEST ? `${words.slice(0, LONGEST - 1)}…` : words;
  document.getElementById("tags").append(node);
  return node;
}

/**
 * Where a name covers no other one, and as few points as may be: left, top, its box, and where a
 * line from its point ends if it is not beside it; null where no place is free.
 */
function place(node, [x, y], { taken, points, size }) {
  const [width, height] = [node.offsetWidth, node.offsetHeight];
  let best = null;
  for (const [ring, room] of ROOMS.entries()) {
    for (const [across, down] of SIDES) {
      const left = across * room + ((across - 1) / 2) * width;
      const top = down * room * (across ? 0.6 : 1) + ((down - 1) / 2) * height;
      const box = [x + left, y + top, x + left + width, y + top + height];
      if (box[0] < 0 || box[1] < 0 || box[2] > size[0] || box[3] > size[1]) continue;
      if (taken.some((other) => meet(box, other))) continue;
      const cost = points.filter((point) => within(point, box)).length + ring / 2;
      const line = ring ? [x + left + ((1 - across) / 2) * width, y + top + ((1 - down) / 2) * height] : null;
      if (!best || cost < best.cost) best = { left, top, box, line, cost };
    }
  }
  return best;
}

function within([x, y], [left, top, right, bottom]) {
  return x > left - NEAR && x < right + NEAR && y > top - NEAR && y < bottom + NEAR;
}

/** What lies over the scene: axes, buttons, the bar of lengths. */
function covers(canvas) {
  const scene = canvas.getBoundingClientRect();
  return ["axes", "zoom", "scale"].map((id) => {
    const { left, top, right, bottom } = document.getElementById(id).getBoundingClientRect();
    return [left - scene.left, top - scene.top, right - scene.left, bottom - scene.top];
  });
}

function around([x, y]) {
  const reach = ROOM - 4;
  return [x - reach, y - reach, x + reach, y + reach];
}

function meet(one, other) {
  return one[0] < other[2] && other[0] < one[2] && one[1] < other[3] && other[1] < one[3];
}
