// Names of points, over the scene: none covers another or a point; the pairs farthest apart come first.

const ROOM = 9; // pixels from a point to its name
const SAME = 14; // pixels: of a pair that is drawn at one place only one point is named
const LONGEST = 12; // letters

/** named: pairs of a row and its name; none where the scene cannot be drawn. */
export class Tags {
  constructor(stage, clouds, named) {
    Object.assign(this, { stage, clouds });
    this.pairs = named.map(([row, words]) => ({ row, made: ["target", "source"].map((cloud) => tag(cloud, words)) }));
  }

  draw() {
    const { stage, clouds, pairs } = this;
    const seen = (row) => [stage.seen(clouds.target, row, false), stage.seen(clouds.source, row, true)];
    const shown = pairs.map(({ row, made }) => ({ made, at: seen(row), far: clouds.distances[row] }));
    shown.sort((one, other) => other.far - one.far);
    const taken = shown.flatMap(({ at }) => at.map(around));
    for (const { made, at } of shown) {
      const apart = Math.hypot(at[0][0] - at[1][0], at[0][1] - at[1][1]) > SAME;
      made.forEach((node, cloud) => {
        const [x, y] = at[cloud];
        node.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
        const free = cloud && !apart ? null : place(node, at[cloud], taken);
        node.style.visibility = free ? "visible" : "hidden";
        if (!free) return;
        taken.push(free.box);
        node.style.left = `${free.left}px`;
        node.style.top = `${free.top}px`;
      });
    }
  }
}

function tag(cloud, words) {
  const node = document.createElement("bdi");
  node.className = `tag ${cloud}`;
  node.textContent = words.length > LONGEST ? `${words.slice(0, LONGEST - 1)}…` : words;
  document.getElementById("tags").append(node);
  return node;
}

/** Where a name is free beside its point, and its box: left, top, right, bottom; else null. */
function place(node, [x, y], taken) {
  const [width, height] = [node.offsetWidth, node.offsetHeight];
  const middle = -height / 2;
  const places = [
    [ROOM, -height], [ROOM, 0], [-ROOM - width, -height], [-ROOM - width, 0],
    [ROOM + 2, middle], [-ROOM - 2 - width, middle], [-width / 2, -ROOM - height], [-width / 2, ROOM],
  ];
  for (const [left, top] of places) {
    const box = [x + left, y + top, x + left + width, y + top + height];
    if (!taken.some((other) => meet(box, other))) return { left, top, box };
  }
  return null;
}

function around([x, y]) {
  const reach = ROOM - 4;
  return [x - reach, y - reach, x + reach, y + reach];
}

function meet(one, other) {
  return one[0] < other[2] && other[0] < one[2] && one[1] < other[3] && other[1] < one[3];
}
