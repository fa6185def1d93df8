// Colours of distances: from those near zero to those that are far, or to the largest.

const STOPS = ["--near", "--middle", "--far"];

/** The three colours of the page, each as red, green, blue from 0 to 1. */
export function ramp(node) {
  const style = getComputedStyle(node);
  return STOPS.map((name) => {
    const digits = style.getPropertyValue(name).trim().slice(1);
    return [0, 2, 4].map((k) => parseInt(digits.slice(k, k + 2), 16) / 255);
  });
}

/** The colour of a share of the largest distance, as CSS writes it. */
export function mixed(stops, share) {
  const at = 2 * Math.min(1, Math.max(0, share));
  const [from, to] = at < 1 ? [stops[0], stops[1]] : [stops[1], stops[2]];
  const part = at < 1 ? at : at - 1;
  return `rgb(${from.map((value, k) => Math.round(255 * (value + part * (to[k] - value)))).join(" ")})`;
}
