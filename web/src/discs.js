// Points drawn as discs or rings of some size in pixels.

import { BufferAttribute, BufferGeometry, Points, ShaderMaterial } from "three";

const VERTEX = `
uniform float size;
void main() {
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_PointSize = size;
}`;

const FRAGMENT = `
uniform vec3 color;
uniform float hole;
uniform float blur;
void main() {
  float r = length(gl_PointCoord * 2.0 - 1.0);
  float alpha = smoothstep(1.0, 1.0 - blur, r) * smoothstep(hole - blur, hole, r);
  if (alpha < 0.05) discard;
  gl_FragColor = vec4(color, alpha);
}`;

/** Points (x, y, z, ...) as discs, or as rings with a hole of that share of their radius. */
export function discs(positions, size, hole = 0) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  const uniforms = {
    size: { value: size },
    hole: { value: hole || -1 },
    blur: { value: Math.min(0.5, 2.5 / size) },
    color: { value: null },
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
