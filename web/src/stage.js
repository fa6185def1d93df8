// The scene: both clouds, the springs between them, the moving body. A pose moves one matrix.

import {
  BufferAttribute,
  BufferGeometry,
  ColorManagement,
  Group,
  LinearSRGBColorSpace,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  PerspectiveCamera,
  Scene,
  Color,
  Vector3,
  WebGLRenderer,
} from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";

import { discs, paint } from "./discs.js";
import { ramp } from "./ramp.js";
import { matrix } from "./rotation.js";

const SHOWN_POINTS = 100_000; // of each cloud; a graphics card draws ten times as many
const SHOWN_SPRINGS = 300; // more hide the clouds
const HELD_POINTS = 2_000; // for which there is to be room
const [FAINT, PLAIN] = [0.35, 0.75]; // opacity of springs: through many the points are to be seen
const SPARSE = 120; // springs that hide nothing
const BODY_POINTS = 60; // bodies of few points are drawn with lines from their centre
const FIELD = 35; // degrees
const FARTHEST = 4; // how far off the body is followed, in radii
const NEARER = 0.5; // what is nearer than the centre looks larger: room for it

/** Draws one pose at a time; `orbit` says from where. Throws where there is no WebGL. */
export class Stage {
  constructor(canvas, clouds, orbit) {
    ColorManagement.enabled = false;
    this.canvas = canvas;
    this.clouds = clouds;
    this.orbit = orbit;
    this.renderer = new WebGLRenderer({
      canvas,
      alpha: true,
      antialias: true,
      preserveDrawingBuffer: true, // so that the page prints what it shows
    });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.camera = new PerspectiveCamera(FIELD, 1, 0.01, 100);
    this.scene = new Scene();
    this.body = new Group();
    this.body.matrixAutoUpdate = false;
    this.scene.add(this.body);
    this.#fill();
    this.away = 0;
    this.held = clouds.rows(HELD_POINTS);
    this.room = orbit.extents(chosen(clouds.target, this.held));
    this.recolour();
  }

  /** Makes room for the body at the poses where it may rest. */
  hold(quaternions) {
    const source = chosen(this.clouds.source, this.held);
    for (const q of quaternions) {
      const found = this.orbit.extents(turned(source, matrix(q)));
      this.room = this.room.map((most, k) => Math.max(most, found[k]));
    }
  }

  #fill() {
    const { clouds } = this;
    const rows = clouds.rows(SHOWN_POINTS);
    const pixels = Math.max(2, 14 - 2.4 * Math.log10(rows.length)) * ratio();
    this.rows = rows;
    this.fixed = discs(chosen(clouds.target, rows), pixels * (pixels > 5 ? 1.35 : 1), pixels > 5 ? 0.62 : 0);
    this.moving = discs(chosen(clouds.source, rows), pixels);
    this.ends = clouds.rows(SHOWN_SPRINGS);
    const springs = new Float32Array(6 * this.ends.length);
    this.springs = clouds.n <= BODY_POINTS ? lines(springs, 2) : hairlines(springs);
    this.springs.renderOrder = -1; // behind the points, wherever they are
    this.moving.renderOrder = 1; // their colours are to be seen: rings and lines hide no disc
    this.fixed.material.depthWrite = false;
    this.scene.add(this.springs, this.fixed);
    this.body.add(this.moving);
    this.frames = [];
    if (clouds.n <= BODY_POINTS) {
      this.frames = [clouds.target, clouds.source].map((points) => lines(spokes(points), 1.5));
      this.scene.add(this.frames[0]);
      this.body.add(this.frames[1]);
    }
  }

  /** Takes the colours of the page, which may have turned dark. */
  recolour() {
    const colour = (name) =>
      new Color(getComputedStyle(this.canvas).getPropertyValue(name).trim());
    const target = colour(this.frames.length ? "--target" : "--ring").toArray();
    paint(this.fixed, [target, target, target]);
    paint(this.moving, ramp(this.canvas));
    this.springs.material.color = colour("--thread");
    this.frames.forEach((frame, i) => {
      frame.material.color = colour(i ? "--source" : "--target");
      frame.material.opacity = 0.45;
    });
  }

  /** Shows a pose, quaternion and offset of the centroids. */
  show(quaternion, offset) {
    const R = matrix(quaternion);
    const [a, b, c] = offset;
    this.body.matrix = new Matrix4().set(
      R[0], R[1], R[2], a, R[3], R[4], R[5], b, R[6], R[7], R[8], c, 0, 0, 0, 1,
    );
    this.body.matrixWorldNeedsUpdate = true;
    this.away = Math.min(Math.hypot(a, b, c), FARTHEST);
    this.#stretch(R, offset);
  }

  /** Colours the source by the distances last measured; most: that at the end of the ramp. */
  tint(most) {
    const { distance_ } = this.moving.geometry.attributes;
    const { distances } = this.clouds;
    const unit = most || 1; // of floats, which hold less than doubles
    this.rows.forEach((row, k) => {
      distance_.array[k] = distances[row] / unit;
    });
    distance_.needsUpdate = true;
    this.moving.material.uniforms.most.value = most > 0 ? 1 : 0;
  }

  #stretch(R, [a, b, c]) {
    const { source: x, target: y } = this.clouds;
    const { instanceStart, position } = this.springs.geometry.attributes;
    const data = instanceStart?.data ?? position;
    this.ends.forEach((row, k) => {
      const [i, j] = [3 * row, 6 * k];
      for (let d = 0; d < 3; d += 1) data.array[j + d] = y[i + d];
      data.array[j + 3] = R[0] * x[i] + R[1] * x[i + 1] + R[2] * x[i + 2] + a;
      data.array[j + 4] = R[3] * x[i] + R[4] * x[i + 1] + R[5] * x[i + 2] + b;
      data.array[j + 5] = R[6] * x[i] + R[7] * x[i + 1] + R[8] * x[i + 2] + c;
    });
    data.needsUpdate = true;
  }

  draw() {
    const { canvas, camera, renderer } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!width || !height) return;
    renderer.setPixelRatio(ratio());
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    const [side, up] = this.room.map((most) => most + this.away);
    const size = Math.max(side / camera.aspect, up, 0.1);
    this.orbit.place(camera, (1.15 * size) / Math.tan((FIELD * Math.PI) / 360) + NEARER);
    camera.updateProjectionMatrix();
    renderer.render(this.scene, camera);
  }

  /** Pixels of a unit of length at the centre of the scene. */
  get pixels() {
    const { canvas, camera } = this;
    return canvas.clientHeight / 2 / Math.tan((FIELD * Math.PI) / 360) / camera.position.length();
  }

  /** Where the axes of the target's frame point on the screen: to the right, and down. */
  get directions() {
    const turned = this.camera.matrixWorldInverse.elements;
    return [0, 1, 2].map((k) => [turned[4 * k], -turned[4 * k + 1], turned[4 * k + 2]]);
  }

  /** Where a point of a cloud is seen, in pixels of the canvas. */
  seen(points, row, moved) {
    const at = new Vector3(points[3 * row], points[3 * row + 1], points[3 * row + 2]);
    if (moved) at.applyMatrix4(this.body.matrix);
    at.project(this.camera);
    const { clientWidth: width, clientHeight: height } = this.canvas;
    return [((at.x + 1) / 2) * width, ((1 - at.y) / 2) * height];
  }
}

function ratio() {
  return Math.min(2, window.devicePixelRatio || 1);
}

function chosen(points, rows) {
  const kept = new Float32Array(3 * rows.length);
  rows.forEach((row, k) => kept.set(points.subarray(3 * row, 3 * row + 3), 3 * k));
  return kept;
}

function turned(points, R) {
  const moved = new Float32Array(points.length);
  for (let i = 0; i < points.length; i += 3) {
    for (let k = 0; k < 3; k += 1) {
      moved[i + k] = R[3 * k] * points[i] + R[3 * k + 1] * points[i + 1] + R[3 * k + 2] * points[i + 2];
    }
  }
  return moved;
}

function spokes(points) {
  const ends = new Float32Array(2 * points.length);
  for (let i = 0; i < points.length; i += 3) ends.set(points.subarray(i, i + 3), 2 * i + 3);
  return ends;
}

/** Lines of one pixel, which cost a tenth of wide ones. */
function hairlines(ends) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(ends, 3));
  const opacity = Math.max(FAINT, Math.min(PLAIN, (PLAIN * 6 * SPARSE) / ends.length));
  const material = new LineBasicMaterial({ transparent: true, opacity, depthWrite: false });
  const segments = new LineSegments(geometry, material);
  segments.frustumCulled = false;
  return segments;
}

function lines(ends, width) {
  const geometry = new LineSegmentsGeometry();
  geometry.setPositions(ends);
  const material = new LineMaterial({ linewidth: width, transparent: true, opacity: 0.8, depthWrite: false });
  const segments = new LineSegments2(geometry, material);
  segments.frustumCulled = false;
  return segments;
}
