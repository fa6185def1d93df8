// Unit quaternions [w, x, y, z]; R(q) takes body coordinates to world.

/** R(q), nine numbers, row by row. */
export function matrix([w, x, y, z]) {
  return [
    w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y),
    2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x),
    2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z,
  ];
}

/** The quaternion along a vector of four numbers. */
export function unit(q) {
  const length = Math.hypot(...q);
  return q.map((entry) => entry / length);
}

/** The rotation a share of the shortest way from p to q. */
export function between(p, q, share) {
  const along = p.reduce((sum, entry, k) => sum + entry * q[k], 0);
  const sign = along < 0 ? -1 : 1;
  const angle = Math.acos(Math.min(1, Math.abs(along)));
  if (angle < 1e-6) return unit(p.map((entry, k) => entry + share * (sign * q[k] - entry)));
  const [a, b] = [Math.sin((1 - share) * angle), sign * Math.sin(share * angle)];
  return unit(p.map((entry, k) => a * entry + b * q[k]));
}

/**
 * The member of a component at some angles: one for a circle, two for a projective plane, three for
 * all rotations. basis: orthonormal quaternions; (0, 0, ..) is the first of them.
 */
export function member(basis, angles) {
  const weights = [];
  let rest = 1;
  for (const angle of [...angles].reverse()) {
    weights.unshift(rest * Math.sin(angle));
    rest *= Math.cos(angle);
  }
  weights.unshift(rest);
  return unit([0, 1, 2, 3].map((k) => weights.reduce((sum, w, i) => sum + w * basis[i][k], 0)));
}
