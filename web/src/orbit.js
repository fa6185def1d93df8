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
      if (!(event.key in KEYS) || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      this.press(event.key);
    });
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      if (!canvas.hasPointerCapture(event.pointerId)) return;
      this.azimuth -= event.movementX * 0.01;
      this.elevation += event.movementY * 0.01;
      this.#settle();
    });
    canvas.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    canvas.addEventListener("dblclick", () => this.press("Home"));
  }

  /** As if a key had been pressed. */
  press(key) {
    KEYS[key](this);
    this.#settle();
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

  /** The direction to the eye at an azimuth and elevation. */
  #towards({ azimuth, elevation }) {
    const [x, y, z] = this.axes;
    const flat = Math.cos(elevation);
    return new Vector3()
      .addScaledVector(x, flat * Math.sin(azimuth))
      .addScaledVector(y, -flat * Math.cos(azimuth))
      .addScaledVector(z, Math.sin(elevation));
  }

  /** How far points (x, y, z, ...) reach to the side and up, as first seen. */
  extents(points) {
    const eye = this.#towards(START);
    const right = this.axes[2].clone().cross(eye).normalize();
    const up = eye.clone().cross(right);
    const point = new Vector3();
    const most = [0, 0];
    for (let i = 0; i < points.length; i += 3) {
      point.fromArray(points, i);
      most[0] = Math.max(most[0], Math.abs(point.dot(right)));
      most[1] = Math.max(most[1], Math.abs(point.dot(up)));
    }
    return most;
  }

  /** Puts a camera at a distance, looking at the centre. */
  place(camera, distance) {
    camera.position.copy(this.#towards(this)).multiplyScalar(distance / this.zoom);
    camera.near = 0.005;
    camera.far = 10 * (distance / this.zoom) + 20;
    camera.up.copy(this.axes[2]);
    camera.lookAt(0, 0, 0);
    camera.updateMatrixWorld();
  }
}
