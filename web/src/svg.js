// Drawings: elements, numbers in words, axes.

const SPACE = "http://www.w3.org/2000/svg";

/** An SVG element; text among the children becomes text, never markup. */
export function svg(tag, attributes = {}, ...children) {
  const node = document.createElementNS(SPACE, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
}

/** A drawing of some size that scales with its place; described for who cannot see it. */
export function drawing(width, height, words, ...children) {
  const box = { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": words };
  return svg("svg", box, ...children);
}

/** A path through points. */
export function path(points, attributes) {
  const d = points.map(([x, y], i) => `${i ? "L" : "M"}${x.toFixed(2)} ${y.toFixed(2)}`).join("");
  return svg("path", { d, fill: "none", ...attributes });
}

export function label(x, y, words, attributes = {}) {
  return svg("text", { x, y, ...attributes }, words);
}

/** A number in a few digits, as people write it. */
export function figure(value, digits = 4) {
  if (!Number.isFinite(value)) return "beyond doubles";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e7 || size < 1e-4) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
    return `${mantissa.replace(/\.?0+$/, "")}e${exponent.replace("+", "")}`;
  }
  return String(Number(value.toPrecision(digits)));
}

/** Round steps of an axis from 0 to a limit, about so many. */
export function steps(limit, count = 4) {
  if (!(limit > 0)) return [0];
  const rough = limit / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((factor) => factor * power >= rough) * power;
  const found = [];
  for (let k = 0; k * step <= limit * (1 + 1e-9); k += 1) found.push(k * step);
  return found;
}

/** Where a chart is drawn: as wide as its place, so that its letters are as large as the page's. */
export function frame(place, height) {
  const width = Math.max(240, Math.min(560, place.clientWidth || 460));
  return { width, height, left: 54, right: width - 12, top: 14, bottom: height - 38 };
}
