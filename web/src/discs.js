// Points drawn as discs or rings of some size in pixels, each with its place on a ramp of colours.

import { BufferAttribute, BufferGeometry, Points, ShaderMaterial, Vector3 } from "three";

const VERTEX = `
uniform float size;
uniform float most;
attribute float distance_;
varying float share;
void main() {
  share = most > 0.0 ? clamp(distance_ / most, 0.0, 1.0) : 0.0;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_PointSize = size;
}`;

const FRAGMENT = `
uniform vec3 ramp[3];
uniform float hole;
uniform float blur;
varying float share;
void main() {
  float r = length(gl_PointCoord * 2.0 - 1.0);
  float alpha = smoothstep(1.0, 1.0 - blur, r) * smoothstep(hole - blur, hole, r);
  if (alpha < 0.05) discard;
  vec3 low = mix(ramp[0], ramp[1], min(1.0, 2.0 * share));
  gl_FragColor = vec4(mix(low, ramp[2], max(0.0, 2.0 * share - 1.0)), alpha);
}`;

/** Points (x, y, z, ...) as discs, or as rings with a hole of that share of their radius. */
export function discs(positions, size, hole = 0) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.setAttribute("distance_", new BufferAttribute(new Float32Array(positions.length / 3), 1));
  const uniforms = {
    size: { value: size },
    hole: { value: hole || -1 },
    blur: { value: Math.min(0.5, 2.5 / size) },
    most: { value: 0 }, // the distance at the end of the ramp
    ramp: { value: [0, 1, 2].map(() => new Vector3()) },
  };
  const material = new ShaderMaterial({
    uniforms,
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    transparent: true,
  });
  const points = new Points(geometry, material);
  points.frustumCulled = false; // a shader's size in pixels is unknown to the culling
  return points;
}

/** Gives points the colours of a ramp: three times red, green, blue. */
export function paint(points, stops) {
  points.material.uniforms.ramp.value.forEach((vector, k) => vector.set(...stops[k]));
}
