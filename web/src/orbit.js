// From where the scene is seen: turned by pointer and keys, on a sphere about its centre.

import { Vector3 } from "three";

const START = { azimuth: -0.35, elevation: 0.6, zoom: 1 };
const KEYS = {
  ArrowLeft: (view) => (view.azimuth -= 0.1),
  ArrowRight: (view) => (view.azimuth += 0.1),
  ArrowUp: (view) => (view.elevation += 0.1),
  ArrowDown: (view) => (view.elevation -= 0.1),
  "+": (view) => (view.zoom *= 1.15),
  "=": (view) => (view.zoom *= 1.15),
  "-": (view) => (view.zoom /= 1.15),
  Home: (view) => Object.assign(view, START),
};

/** axes: three orthonormal rows; the scene is first seen from between the second and the third. */
export class Orbit {
  constructor(canvas, axes, changed) {
    this.axes = axes.map((row) => new Vector3(...row));
    this.changed = changed;
    Object.assign(this, START);
    canvas.addEventListener("keydown", (event) => {
      const turn = KEYS[event.key];
      if (!turn || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      turn(this);
      this.#settle();
    });
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      if (!canvas.hasPointerCapture(event.pointerId)) return;
      this.azimuth -= event.movementX * 0.01;
      this.elevation += event.movementY * 0.01;
      this.#settle();
    });
    canvas.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    canvas.addEventListener("dblclick", () => {
      Object.assign(this, START);
      this.#settle();
    });
  }

  /** Zooms with Ctrl or a pinch only: a wheel alone scrolls the page. */
  #wheel(event) {
    if (!event.ctrlKey) return;
    event.preventDefault();
    this.zoom *= Math.exp(-0.005 * event.deltaY);
    this.#settle();
  }

  #settle() {
    this.elevation = Math.min(1.55, Math.max(-1.55, this.elevation));
    this.zoom = Math.min(50, Math.max(0.1, this.zoom));
    this.changed();
  }

  /** Puts a camera at a distance, looking at the centre. */
  place(camera, distance) {
    const [x, y, z] = this.axes;
    const flat = Math.cos(this.elevation);
    camera.position.set(0, 0, 0);
    camera.position.addScaledVector(x, flat * Math.sin(this.azimuth));
    camera.position.addScaledVector(y, -flat * Math.cos(this.azimuth));
    camera.position.addScaledVector(z, Math.sin(this.elevation));
    camera.position.multiplyScalar(distance / this.zoom);
    camera.near = (0.01 * distance) / this.zoom;
    camera.far = (10 * distance) / Math.min(1, this.zoom) + 20;
    camera.up.copy(z);
    camera.lookAt(0, 0, 0);
    camera.updateMatrixWorld();
  }
}
