"""A small producer of certificates, independent of the package: NumPy finds, Fractions decide."""

from __future__ import annotations

import base64
import hashlib
import json
import struct
from fractions import Fraction
from itertools import pairwise, permutations
from math import lcm
from typing import Any

import numpy as np

PREFIX = b"certreg-problem/1\0"
QUATERNION_BITS = 60


def problem_bytes(source, target, weights) -> bytes:
    """What the digest is taken of."""
    numbers = [*np.ravel(source), *np.ravel(target), *np.ravel(weights)]
    numbers = [float(number) + 0.0 for number in numbers]
    return PREFIX + struct.pack(f"<Q{len(numbers)}d", len(weights), *numbers)


def exact_moments(source, target, weights):
    """(M, C, S2) in Fractions, by the definitions; added up in integers, over one denominator."""
    X, x_unit = _whole(source)
    Y, y_unit = _whole(target)
    (w,), w_unit = _whole([weights])
    mass = sum(w)

    def centred(cloud):
        """The deviations from the mean, times the mass."""
        sums = [sum(m * row[k] for m, row in zip(w, cloud, strict=True)) for k in range(3)]
        return [[mass * row[k] - sums[k] for k in range(3)] for row in cloud]

    def second(left, right, unit):
        pairs = [(j, k) for j in range(3) for k in range(3)]
        sums = {
            (j, k): sum(m * a[j] * b[k] for m, a, b in zip(w, left, right, strict=True))
            for j, k in pairs
        }
        over = mass * mass * w_unit * unit
        return [[Fraction(sums[j, k], over) for k in range(3)] for j in range(3)]

    X, Y = centred(X), centred(Y)
    return Fraction(mass, w_unit), second(Y, X, x_unit * y_unit), second(X, X, x_unit**2)


def _whole(rows) -> tuple[list[list[int]], int]:
    """Rows of numbers times their common denominator, and that."""
    exact = [[Fraction(float(value)) for value in row] for row in rows]
    common = lcm(*(value.denominator for row in exact for value in row))
    return [[int(value * common) for value in row] for row in exact], common


def rotation_form(C):
    """The matrix of the quadratic form q -> |q|^2 tr(R(q)^T C), from its values."""

    def trace(q):
        w, x, y, z = q
        R = (
            (w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z),
        )
        return sum(R[j][k] * C[j][k] for j in range(3) for k in range(3))

    def polar(j, k):
        return trace([(i == j) + (i == k) for i in range(4)])

    values = [polar(k, k) / 4 for k in range(4)]
    return [
        [values[j] if j == k else (polar(j, k) - values[j] - values[k]) / 2 for k in range(4)]
        for j in range(4)
    ]


def determinant(A):
    """Leibniz' formula."""
    total = 0
    for order in permutations(range(len(A))):
        inversions = sum(a > b for k, a in enumerate(order) for b in order[k + 1 :])
        term = (-1) ** inversions
        for row, column in enumerate(order):
            term *= A[row][column]
        total += term
    return total


def positive_definite(A) -> bool:
    """By Sylvester's minors, of the matrix times its common denominator."""
    common = lcm(*(Fraction(entry).denominator for row in A for entry in row))
    A = [[int(entry * common) for entry in row] for row in A]
    return all(determinant([row[:k] for row in A[:k]]) > 0 for k in range(1, len(A) + 1))


def optimality_matrix(K, q, delta, mu):
    norm = sum(c * c for c in q)
    value = sum(q[j] * K[j][k] * q[k] for j in range(4) for k in range(4)) / Fraction(norm)
    return [
        [
            (value + delta - mu) * (j == k) - K[j][k] + mu * Fraction(q[j] * q[k], norm)
            for k in range(4)
        ]
        for j in range(4)
    ]


def power_above(value: Fraction) -> list[int]:
    """[1, e] with 2^e > value > 0, at most 4 value."""
    exponent = value.numerator.bit_length() - value.denominator.bit_length() + 1
    return [1, exponent]


def produce(source, target, weights=None, *, pattern=None, unstable=None) -> dict[str, Any]:
    """A certificate, as the dictionary that the file holds; it claims as much as can be proved.

    pattern: the true multiplicities, where NumPy cannot be trusted with them.
    """
    weights = np.ones(len(source)) if weights is None else np.asarray(weights, dtype=float)
    _, C, S2 = exact_moments(source, target, weights)
    K = rotation_form(C)
    scale: Any = max(abs(entry) for row in K for entry in row) or Fraction(1)
    values, vectors = np.linalg.eigh(np.array([[float(e / scale) for e in row] for row in K]))
    pattern = pattern or [1, 1, 1, 1]
    q = [round(float(c) * 2**QUATERNION_BITS) for c in vectors[:, 3]]
    mu = [0, 0]
    if pattern[0] == 1:
        mu = power_above(Fraction(float(values[3] - values[2])) * scale / 8)
    exponent = power_above(scale)[1] - 2 * QUATERNION_BITS
    while not positive_definite(
        optimality_matrix(K, q, Fraction(2) ** exponent, mu[0] * Fraction(2) ** mu[1])
    ):
        exponent += 1
    trace = S2[0][0] + S2[1][1] + S2[2][2]
    J = [[trace * (j == k) - S2[j][k] for k in range(3)] for j in range(3)]
    indices = [sum(pattern[:k]) for k in range(len(pattern))] if positive_definite(J) else None
    content = problem_bytes(source, target, weights)
    return {
        "about": {"made by": "the tests"},
        "basin": None,
        "claims": {
            "basin": None,
            "gap": [1, exponent + 1],
            "pattern": pattern,
            "sdp_gap": None,
            "sin2_half_angle": [1, exponent - mu[1]] if mu[0] else None,
            "unique": pattern[0] == 1,
            "unstable": indices if unstable is None else unstable,
        },
        "format": "certreg-certificate/1",
        "kind": "isotropic",
        "optimality": {"delta": [1, exponent], "mu": mu},
        "pose": q,
        "problem": stated_problem(content, len(weights)),
        "sdp": None,
    }


def produce_quickly(source, target, weights) -> dict[str, Any]:
    """A certificate with loose bounds, found in floating point alone: for many points."""
    mass = weights.sum()
    x, y = source - weights @ source / mass, target - weights @ target / mass
    K = np.array(rotation_form(((y * weights[:, None]).T @ x).tolist()))
    values, vectors = np.linalg.eigh(K)
    gap = Fraction(float(values[3] - values[2]))
    mu, delta = power_above(gap / 8), power_above(gap / 2**18)
    small = produce(*random_problem(0, n=4))
    small["claims"].update(gap=[1, delta[1] + 1], sin2_half_angle=[1, delta[1] - mu[1]])
    small.update(
        pose=[round(float(c) * 2**QUATERNION_BITS) for c in vectors[:, 3]],
        optimality={"delta": delta, "mu": mu},
        problem=stated_problem(problem_bytes(source, target, weights), len(weights)),
    )
    return small


def stated_problem(content: bytes, n: int) -> dict[str, Any]:
    return {
        "data": base64.b64encode(content).decode(),
        "digest": hashlib.sha256(content).hexdigest(),
        "n": n,
    }


def dump(certificate) -> bytes:
    return json.dumps(certificate, sort_keys=True).encode()


def with_problem(certificate, content: bytes) -> dict[str, Any]:
    """The certificate with other bytes of data, and their digest."""
    return {**certificate, "problem": stated_problem(content, certificate["problem"]["n"])}


def multiplicities(K) -> list[int]:
    """From the exact number of distinct eigenvalues, and NumPy's for which of them coincide."""
    polynomial: list[Any] = [Fraction(1)]  # Faddeev and LeVerrier; the leading coefficient first
    A: list[list[Any]] = [[Fraction(0)] * 4 for _ in range(4)]
    for step in range(1, 5):
        for j in range(4):
            A[j][j] += polynomial[-1]
        A = [[sum(K[j][i] * A[i][k] for i in range(4)) for k in range(4)] for j in range(4)]
        polynomial.append(-sum(A[j][j] for j in range(4)) / step)
    derivative = [(4 - k) * c for k, c in enumerate(polynomial[:4])]
    distinct = 4 - (len(_common_divisor(polynomial, derivative)) - 1)
    scale = max(abs(entry) for row in K for entry in row) or Fraction(1)
    values = np.linalg.eigvalsh(np.array([[float(e / scale) for e in row] for row in K]))[::-1]
    drops = np.argsort(np.diff(values), kind="stable")[: distinct - 1]
    edges = [0, *sorted(int(k) + 1 for k in drops), 4]
    return [b - a for a, b in pairwise(edges)]


def _common_divisor(p, q):
    while any(q):
        while not q[0]:
            q = q[1:]
        p = list(p)
        while len(p) >= len(q):
            factor = p[0] / q[0]
            p = [a - factor * b for a, b in zip(p, [*q, *[0] * len(p)], strict=False)][1:]
        p, q = q, p
    return p


def holds(certificate) -> bool:
    """Whether a certificate of the right form is true: by definitions, without any shortcut."""
    problem, claims, q = certificate["problem"], certificate["claims"], certificate["pose"]
    content, n = base64.b64decode(problem["data"], validate=True), problem["n"]
    if content[:26] != PREFIX + struct.pack("<Q", n) or len(content) != 26 + 56 * n:
        return False
    if hashlib.sha256(content).hexdigest() != problem["digest"]:
        return False
    numbers = struct.unpack(f"<{7 * n}d", content[26:])
    if not np.isfinite(numbers).all() or any(w < 0 for w in numbers[6 * n :]):
        return False
    if not any(numbers[6 * n :]) or not any(q):
        return False
    source, target = (np.reshape(numbers[k : k + 3 * n], (n, 3)) for k in (0, 3 * n))
    _, C, S2 = exact_moments(source, target, numbers[6 * n :])
    K, trace = rotation_form(C), S2[0][0] + S2[1][1] + S2[2][2]
    delta, mu = (_value(certificate["optimality"][name]) for name in ("delta", "mu"))
    J = [[trace * (j == k) - S2[j][k] for k in range(3)] for j in range(3)]
    pattern, sin2 = multiplicities(K), claims["sin2_half_angle"]
    indices = [sum(pattern[:k]) for k in range(len(pattern))]
    return (
        mu >= 0
        and positive_definite(optimality_matrix(K, q, delta, mu))
        and _value(claims["gap"]) >= 2 * delta
        and (sin2 is None or (mu > 0 and _value(sin2) >= delta / mu))
        and claims["pattern"] == pattern
        and (pattern[0] == 1 or not claims["unique"])
        and claims["unstable"] in (None, indices if positive_definite(J) else None)
    )


def _value(dyadic) -> Fraction:
    return dyadic[0] * Fraction(2) ** dyadic[1]


def random_problem(seed: int, n: int = 20, noise: float = 0.05):
    """Generic clouds (source, target, weights): pattern 1, 1, 1, 1."""
    random = np.random.default_rng(seed)
    source = random.normal(size=(n, 3)) + random.normal(size=3)
    R, _ = np.linalg.qr(random.normal(size=(3, 3)))
    R *= np.linalg.det(R)
    target = source @ R.T + random.normal(size=3) + noise * random.normal(size=(n, 3))
    return source, target, 1 / random.uniform(0.5, 2, size=n) ** 2


OCTAHEDRON = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]


def stretched(factors):
    """An octahedron scaled along its axes: C is diagonal."""
    return [[a * b for a, b in zip(row, factors, strict=True)] for row in OCTAHEDRON]


# (multiplicities, source, target); C = diag(products of the factors, times 2) unless told
PATTERNS = {
    "generic": ([1, 1, 1, 1], stretched((3, 2, 1)), stretched((3, 2, 1))),
    "rectangle": ([1, 1, 1, 1], *[[[2, 1, 0], [-2, 1, 0], [2, -1, 0], [-2, -1, 0]]] * 2),
    "mirrored": ([1, 1, 1, 1], stretched((3, 2, 1)), stretched((3, 2, -1))),
    "square": ([1, 2, 1], *[[[1, 1, 0], [-1, 1, 0], [1, -1, 0], [-1, -1, 0]]] * 2),
    "mirrored, compressed": ([1, 2, 1], stretched((2, 2, 1)), stretched((2, 2, -1))),
    "elongated": ([1, 1, 2], stretched((2, 1, 1)), stretched((2, 1, 1))),
    "octahedron": ([1, 3], OCTAHEDRON, OCTAHEDRON),
    "triangle": ([1, 2, 1], *[[[1, 0, 0], [0, 1, 0], [0, 0, 1]]] * 2),
    "mirrored, elongated": ([2, 1, 1], stretched((2, 1, 1)), stretched((2, 1, -1))),
    "mirrored octahedron": ([3, 1], OCTAHEDRON, stretched((1, 1, -1))),
    "collinear source": (
        [2, 2],
        [[1, 1, 3], [2, 2, 3], [4, 4, 3]],  # not through the origin: the means matter
        [[0, 1, 5], [0, 2, 0], [1, 7, 0]],
    ),
    "collinear target": ([2, 2], OCTAHEDRON, [[k, 2 * k, -k] for k in range(6)]),
    "antipodes": (
        [4],
        OCTAHEDRON,
        [[5, 0, 1], [5, 0, 1], [0, 3, 0], [0, 3, 0], [1, 1, 1], [1, 1, 1]],
    ),
    "one point": ([4], [[1, 2, 3]], [[4, 5, 6]]),
}
