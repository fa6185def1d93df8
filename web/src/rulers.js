// A bar of a round length and the directions of the axes, over the scene.

import { figure, label, path } from "./svg.js";

const LONGEST = 130; // pixels
const ARM = 26; // of an axis that lies in the screen
const NAMES = ["x", "y", "z"];

/** What is read off the scene; length: one unit of the scene in the unit of the data. */
export class Rulers {
  /** length: of the scene's unit; unit: what lengths are told in, in words. */
  constructor(length, unit) {
    Object.assign(this, { length, unit });
    this.scale = document.getElementById("scale");
    this.axes = document.getElementById("axes");
    this.scale.title = "At the centre of the scene: what is nearer looks larger";
  }

  draw(stage) {
    const pixel = this.length / stage.pixels;
    const round = roundBelow(LONGEST * pixel);
    this.scale.hidden = !(round > 0 && Number.isFinite(round));
    this.scale.firstElementChild.style.width = `${round / pixel}px`;
    this.scale.lastElementChild.textContent = `${figure(round)} in the ${this.unit}`;
    const arms = stage.directions.map((arm, k) => [arm, NAMES[k]]).sort(([a], [b]) => a[2] - b[2]);
    this.axes.replaceChildren(...arms.flatMap(([[right, down], name]) => {
      const [x, y] = [ARM * right, ARM * down];
      const centred = { class: "tick", "text-anchor": "middle" };
      return [path([[0, 0], [x, y]], { class: "axis" }), label(1.32 * x, 1.32 * y + 4, name, centred)];
    }));
  }
}

/** The largest of 1, 2, 5 times a power of ten that is not above a limit. */
function roundBelow(limit) {
  const power = 10 ** Math.floor(Math.log10(limit));
  return [5, 2, 1].find((factor) => factor * power <= limit) * power;
}
