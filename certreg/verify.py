"""The trusted checker of certreg: one file, standard library only, exact integer arithmetic.

    python3 -I -S verify.py certificate.json

prints each theorem that it established about the data, then VERIFIED or REFUSED and the reason
(exit code 0 or 1; 2: unreadable file, wrong usage). It recomputes everything from the points: what
a certificate holds makes the proof short and is never believed. No floating point decides.

Pairs x_i (source), y_i (target), weights w_i >= 0, M = sum w_i > 0; C = sum w_i y_i x_i^T and
S2 = sum w_i x_i x_i^T, both after subtracting the weighted means; J = tr(S2) I - S2. The objective
of a rotation R is min over t of sum w_i |y_i - R x_i - t|^2 = constant - 2 tr(R^T C). Quaternions
are (w, x, y, z). K is the symmetric matrix with q^T K q = tr(R(q)^T C) for unit q.
"""

from __future__ import annotations

import base64
import hashlib
import json
import struct
import sys
from array import array
from dataclasses import dataclass
from decimal import ROUND_CEILING, Context, Decimal
from fractions import Fraction
from itertools import accumulate, chain
from math import frexp, gcd, isfinite, isqrt, lcm
from operator import mul
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

Matrix = list[list[int]]
PREFIX, FORMAT = b"certreg-problem/1\0", "certreg-certificate/1"
KEYS = {  # of kind isotropic and its parts; any others are refused; basin and sdp may be null
    "": "about basin claims format kind optimality pose problem sdp",
    "basin": "angular_velocity quaternion",
    "sdp": "nu",
    "claims": "basin gap pattern sdp_gap sin2_half_angle unique unstable",
    "optimality": "delta mu",
    "problem": "data digest n",
}
DYADICS = ("delta", "gap", "mu", "nu", "sdp_gap", "sin2_half_angle")  # [m, e] means m 2^e
FREE = ("pattern", "unstable")  # lists of one to four integers; these have four:
LISTS = ("angular_velocity", "chart", "pose", "quaternion", *FREE, *DYADICS)
SCALARS: Any = {"n": int, "unique": bool, "basin": bool, "data": str, "digest": str}
NULLS = ("angular_velocity", "basin", "data", "nu", "quaternion", *DYADICS[-2:], "unstable")
INLINE_MAX, FILE_MAX = 10**6, 10**8  # points in a certificate, 75 MB in base64; its bytes
NODES_MAX = 50_000  # commas and brackets; each costs less than 600 bytes of memory: < 30 MB
DIGITS_MAX, EXPONENT_MAX = 4300, 32768  # of an integer, as Python's own limit; of a dyadic
BLOCK = 8192  # points lifted at a time: bounds the memory
UNIT = 3 * (1073 + 53)  # each double is an integer times 2^-1126, a product of three 2^-UNIT
KINDS = ("", "one rotation", "a circle", "a projective plane", "all rotations")


class RefusalError(Exception):
    """The certificate does not prove what it claims; the message says what is wrong."""


@dataclass(frozen=True)
class Outcome:
    """What `check` found: theorems in words with numbers, or else the reason for refusing."""

    verified: bool
    theorems: tuple[str, ...]
    reason: str


@dataclass(frozen=True)
class Clouds:
    """Points that a certificate must be about: 3n, 3n and n numbers; row i pairs with row i."""

    source: tuple[float, ...] | array[float]
    target: tuple[float, ...] | array[float]
    weights: array[float] | None = None  # None: all equal, those of the certificate if it has any


def require(condition: object, reason: str) -> None:
    """Nothing if the condition holds; otherwise RefusalError."""
    if not condition:
        raise RefusalError(reason)


def parse(text: bytes) -> dict[str, Any]:
    """All fields of a well-formed certificate, of checked types and sizes, in one dictionary."""
    nodes = sum(map(text.count, (b",", b"[", b"{")))
    require(len(text) <= FILE_MAX and nodes <= NODES_MAX, "the certificate is too large")
    hooks: dict[str, Any] = {"parse_int": _bounded, "parse_constant": _bounded}
    try:
        document = json.loads(text.decode(), object_pairs_hook=_unique, **hooks)
    except (ValueError, RecursionError) as error:
        raise RefusalError("the certificate is not JSON in UTF-8 of a sane depth") from error
    fields: dict[str, Any] = {"": document}
    kind = document["kind"] if _is(dict, document) and _is(str, document.get("kind")) else ""
    for name, keys in FORMS.get(kind, FORMS["isotropic"])[0].items():
        absent = name in {"basin", "sdp"} and fields[name] is None
        part = dict.fromkeys(keys.split()) if absent else fields[name]
        good = _is(dict, part) and sorted(part) == keys.split()
        require(good, f"{name or 'the certificate'} must have exactly the keys {keys}")
        fields.update(part)  # in this order: `basin` ends as the claim of that name
    known = _is(dict, fields["about"]) and kind in FORMS
    require(known and fields["format"] == FORMAT, f"not a {FORMAT} of a known kind")
    present = [name for name in (*SCALARS, *LISTS) if name in fields]
    for name in [name for name in present if fields[name] is not None or name not in NULLS]:
        value = fields[name]
        require(_is(SCALARS.get(name, list), value), f"{name} is of a wrong type")
        if name in LISTS:
            length = 2 if name in DYADICS else len(value) if name in FREE else 4
            good = len(value) == length <= 4 and all(_is(int, entry) for entry in value)
            require(good, f"{name} is not a list of integers of the right length")
        if name in DYADICS:
            fields[name] = value[0] * _power(value[1])
    return fields


def _power(exponent: int) -> Fraction:
    require(abs(exponent) <= EXPONENT_MAX, "an exponent is too large")
    return Fraction(2) ** exponent


def _is(kind: type, value: object) -> bool:
    return type(value) is kind  # not isinstance: a bool is no int here


def _unique(pairs: list[tuple[str, object]]) -> dict[str, object]:
    require(len(pairs) == len(dict(pairs)), "a key appears twice")
    return dict(pairs)


def _bounded(digits: str) -> int:
    require(len(digits) <= DIGITS_MAX, f"an integer has more than {DIGITS_MAX} digits")
    return int(digits)  # ValueError for NaN and Infinity


def bound_doubles(fields: dict[str, Any], clouds: Clouds | None) -> memoryview:
    """Little-endian doubles source, target, weights (7n) that the digest, SHA-256, binds.

    From the certificate, or from `clouds` where it holds none; where both are given, they agree.
    """
    n, text, content = fields["n"], fields["data"], b""
    require(1 <= n < 2**40, "n is out of range")
    head, size = PREFIX + struct.pack("<Q", n), len(PREFIX) + 8 + 56 * n
    if text is not None:
        require(n <= INLINE_MAX and len(text) == (size + 2) // 3 * 4, "data is not of n points")
        try:
            content = base64.b64decode(text, validate=True)
        except ValueError as error:
            raise RefusalError("data is not base64") from error
        last = base64.b64encode(content[(size - 1) // 3 * 3 :]).decode()  # where bits may be left
        good = content.startswith(head) and len(content) == size and text.endswith(last)
        require(good, "data is not canonical, or not of n points")
    require(content or clouds, "the certificate holds no points: give SOURCE and TARGET")
    if clouds:
        parts = [p for p in (clouds.source, clouds.target, clouds.weights) if p is not None]
        same = [len(part) for part in parts] == [3 * n, 3 * n, n][: len(parts)]
        require(same, "the certificate is about another number of points or weights")
        given = array("d", map((0.0).__add__, chain(*parts)))  # 0.0 + -0.0 = 0.0
        if sys.byteorder == "big":
            given.byteswap()
        given = head + given.tobytes()
        content = content or given + struct.pack("<d", 1.0) * ((size - len(given)) // 8)
        require(content.startswith(given), "the certificate is about other points or weights")
    fields["equal"] = content[-8:] * n == content[-8 * n :]  # all weights
    known = fields["equal"] or clouds is None or clouds.weights is not None
    require(known, "the certificate weights its points unequally: give the weights, too")
    require(hashlib.sha256(content).hexdigest() == fields["digest"], "the digest is not theirs")
    return memoryview(content)[len(head) :]


def moments(doubles: bytes | memoryview, n: int) -> tuple[Matrix, int]:
    """4x7 table m and e: sum w a_i a_j = m[i][j] 2^e for i <= j; a = (1, x1, x2, x3, y1, y2, y3).

    Exact: the doubles of a block are integers times one power of two, at least 2^-1126.
    """
    table = [[0] * 7 for _ in range(4)]
    for start in range(0, n, BLOCK):
        count = min(BLOCK, n - start)
        x, e = _lifted(doubles, 3 * start, 3 * count)
        y, f = _lifted(doubles, 3 * (n + start), 3 * count)
        w, g = _lifted(doubles, 6 * n + start, count)
        require(min(w) >= 0, "a weight is negative")
        a = [[1] * count, *(k[i::3] for k in (x, y) for i in range(3))]
        places = [0, e, e, e, f, f, f]
        for i, left in enumerate(a[:4]):
            weighted = list(map(mul, w, left))
            for j in range(i, 7):
                table[i][j] += sum(map(mul, weighted, a[j])) << UNIT + g + places[i] + places[j]
    common = gcd(*chain(*table)) or 1
    shift = (common & -common).bit_length() - 1
    return [[entry >> shift for entry in row] for row in table], shift - UNIT


def _lifted(doubles: bytes | memoryview, first: int, count: int) -> tuple[list[int], int]:
    """Integers k and one exponent e such that the doubles are k 2^e."""
    values = struct.unpack_from(f"<{count}d", doubles, 8 * first)
    require(all(map(isfinite, values)), "the data hold a number that is not finite")
    bits = struct.unpack_from(f"<{count}Q", doubles, 8 * first)
    require(1 << 63 not in bits, "the data hold -0.0, which is not canonical")
    split = [frexp(value) for value in values]  # value = k 2^e, k 2^53 an integer
    low = min((e for k, e in split if k), default=0)
    return [int(k * 2**53) << (e - low) if k else 0 for k, e in split], low - 53


def davenport(C: Matrix) -> Matrix:
    """4x4 matrix K of the 3x3 matrix C: symmetric, q^T K q = tr(R(q)^T C) for unit q."""
    trace = C[0][0] + C[1][1] + C[2][2]
    z = [C[2][1] - C[1][2], C[0][2] - C[2][0], C[1][0] - C[0][1]]
    block = [[C[i][j] + C[j][i] - trace * (i == j) for j in range(3)] for i in range(3)]
    return [[trace, *z], *([z[i], *block[i]] for i in range(3))]


def positive_definite(A: Sequence[Sequence[int | Fraction]]) -> bool:
    """Whether the symmetric matrix A is positive definite: all leading minors > 0 (Sylvester).

    They are the pivots of Bareiss' elimination, whose divisions leave no remainder.
    """
    common = lcm(*(entry.denominator for entry in chain(*A)))
    rows, previous = [[int(entry * common) for entry in row] for row in A], 1
    for k, row in enumerate(rows):
        if row[k] <= 0:
            return False
        for below in rows[k + 1 :]:
            for j in range(len(row) - 1, k - 1, -1):
                below[j] = (below[j] * row[k] - below[k] * row[j]) // previous
        previous = row[k]
    return True


def _form(A: Matrix, v: list[int]) -> int:  # v^T A v
    return sum(entry * sum(map(mul, row, v)) for entry, row in zip(v, A))  # noqa: B905 (3.9)


def proves_level(K: Matrix, unit: Fraction, q: list[int], level: Fraction, mu: Fraction) -> bool:
    """Whether A = level I - K + mu u u^T is positive definite; u = q/|q|, K given over unit.

    Where it is, mu >= 0 and level = v + delta - mu, v = u^T K u, every unit quaternion p satisfies
        p^T K p - v < delta - mu (1 - (u.p)^2).                                              (*)
    Gap: objective(R(u)) - objective(R(p)) = 2 (p^T K p - v) < 2 delta.
    Angle: let p be optimal, 0 <= p^T K p - v, and R(u), R(p) be an angle a apart, so that
    1 - (u.p)^2 = sin^2(a/2): sin^2(a/2) < delta/mu if mu > 0.
    Unique if delta <= mu: were the largest eigenvalue of K double, its eigenspace would hold a
    unit p orthogonal to u, for which (*) says p^T K p < v + delta - mu <= v: not the largest.
    With mu = 0 every p^T K p < level: the gap is below 2 (level - v), the dual's own bound.
    """
    square = sum(c * c for c in q)
    rows = [[Fraction(mu * a * b, square) / unit for b in q] for a in q]
    diagonal = level / unit
    return positive_definite(
        [[rows[i][j] - K[i][j] + diagonal * (i == j) for j in range(4)] for i in range(4)]
    )


def proves_basin(fields: dict[str, Any], K: Matrix, J: Matrix, level: Fraction) -> bool:
    """Whether a body in the state (p, w), w its angular velocity, must end at the optimum; J > 0.

    E = w^T J w / 2 - 2 p^T K p, p a unit quaternion, never rises along the damped motion, which
    ends at an equilibrium (LaSalle). One that is not optimal has p^T K p at most the second
    eigenvalue of K, and by (*) that is < level = v + delta - mu, the bound across u. So
    p^T K p - w^T J w / 4 > level leaves only the optimum. K, J and level are over one unit.
    """
    p, (*w, exponent) = fields["quaternion"], fields["angular_velocity"]
    spin = Fraction(_form(J, w), 4) * _power(exponent) ** 2
    return any(p) and Fraction(_form(K, p), sum(c * c for c in p)) - spin > level


def multiplicities(C: Matrix) -> list[int]:
    """Multiplicities of the eigenvalues of K, from the largest on; a factor > 0 of C is no matter.

    Let d1 >= d2 >= |d3| be the singular values of C, d3 with the sign of D = det C. K has the
    eigenvalues d1+d2+d3, d1-d2-d3, -d1+d2-d3, -d1-d2+d3: neighbours coincide where d2 = -d3,
    d1 = d2, d2 = d3. e1, e2, e3 are the symmetric functions of the d_i^2, eigenvalues of C^T C;
    two of these coincide where the discriminant is 0, and s = 2 (b - a)^3 for (a, a, b).
    """
    divisor = gcd(*chain(*C)) or 1
    (a, b, c), (d, e, f), (g, h, i) = rows = [[entry // divisor for entry in row] for row in C]
    P = [sum(row[j] * row[k] for row in rows) for j in range(3) for k in range(3)]  # C^T C
    D = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    e1 = P[0] + P[4] + P[8]
    e2, e3 = (e1 * e1 - sum(map(mul, P, P))) // 2, D * D
    s = 2 * e1**3 - 9 * e1 * e2 + 27 * e3
    if e1**2 * e2**2 - 4 * e2**3 - 4 * e1**3 * e3 + 18 * e1 * e2 * e3 - 27 * e3**2 != 0:
        return [1, 1, 1, 1]
    if e2 == 0:
        return [2, 2] if e1 else [4]
    if s == 0:
        return [1, 3] if D > 0 else [3, 1]
    return [1, 2, 1] if s < 0 else [1, 1, 2] if D > 0 else [2, 1, 1]


def check(certificate: bytes, clouds: Clouds | None = None) -> Outcome:
    """Theorems that the certificate proves of its points, or why it is refused; never raises.

    A claim weaker than what is proved passes, a stronger one does not.
    """
    try:
        fields = parse(certificate)
        del certificate  # as large as the points
        m, e = moments(bound_doubles(fields, clouds), fields["n"])
        return Outcome(verified=True, theorems=FORMS[fields["kind"]][1](fields, m, e), reason="")
    except (RefusalError, MemoryError) as error:
        return Outcome(verified=False, theorems=(), reason=str(error) or "not enough memory")


def _prove(fields: dict[str, Any], m: Matrix, e: int) -> tuple[str, ...]:
    q, delta, mu, sin2 = (fields[name] for name in ("pose", "delta", "mu", "sin2_half_angle"))
    require(delta > 0 and mu >= 0 and any(q), "delta > 0, mu >= 0 and a pose other than 0 needed")
    mass, xyz = m[0][0], (1, 2, 3)
    require(mass > 0, "no weight is positive")
    unit = Fraction(2) ** e / mass  # of K and J below, which are M K and M J
    C = [[mass * m[k][j] - m[0][k] * m[0][j] for k in xyz] for j in (4, 5, 6)]
    S = [[mass * m[min(j, k)][max(j, k)] - m[0][k] * m[0][j] for k in xyz] for j in xyz]
    trace = S[0][0] + S[1][1] + S[2][2]
    J = [[trace * (i == j) - S[i][j] for j in range(3)] for i in range(3)]
    solid, pattern, K = positive_definite(J), multiplicities(C), davenport(C)
    v = Fraction(_form(K, q), sum(c * c for c in q)) * unit
    level = v + delta - mu
    require(proves_level(K, unit, q, level, mu), "delta and mu do not prove the pose optimal")
    require(fields["gap"] >= 2 * delta, "claims.gap is below the proved bound 2 delta")
    angle = sin2 is None or (mu > 0 and sin2 * mu >= delta)
    require(angle, "claims.sin2_half_angle is below the proved bound delta/mu")
    require(fields["pattern"] == pattern, f"claims.pattern is wrong, the true one is {pattern}")
    require(pattern[0] == 1 or not fields["unique"], "claims.unique is wrong: it is not unique")
    unstable = [0, *accumulate(pattern[:-1])] if solid else None  # collinear: no dynamics
    good = fields["unstable"] in (None, unstable)
    require(good, f"claims.unstable is wrong or unproved: proved is {unstable}")
    nu, sdp_gap = fields["nu"], fields["sdp_gap"]
    require(nu is None or proves_level(K, unit, q, nu, Fraction(0)), "sdp.nu bounds nothing")
    bounded = sdp_gap is None or (nu is not None and sdp_gap >= 2 * (nu - v))
    require(bounded, "claims.sdp_gap is below the proved bound 2 (nu - v)")
    if fields["basin"]:
        stated = solid and fields["quaternion"] and fields["angular_velocity"]
        inside = stated and proves_basin(fields, K, J, level / unit)
        require(inside, "claims.basin is not proved of the state in basin")
    return tuple(_sentences(fields, pattern, solid=solid))


def _sentences(fields: dict[str, Any], pattern: list[int], *, solid: bool) -> Iterator[str]:
    q, delta, mu = fields["pose"], fields["delta"], fields["mu"]
    yield f"Data: n = {fields['n']} pairs, {'' if fields['equal'] else 'NOT '}all of one weight."
    yield f"SHA-256 of their doubles is {fields['digest']}."
    length = isqrt(sum(c * c for c in q) << 128)
    unit = ", ".join(f"{(c << 64) / length:.12f}" for c in q)
    yield f"The certified rotation R is that of the quaternion ({unit}), rounded here; w first."
    gap = f"{rounded_up(2 * delta, 2):.1e} (sum of weight x squared distance)"
    yield f"The objective at R, best translation, exceeds the global minimum by less than {gap}."
    if 2 * delta <= mu:  # a/2 < tan(a/2) < sqrt(s/(1 - s)) if sin^2(a/2) < s = delta/mu
        context = Context(prec=20)
        root = context.next_plus(context.sqrt(rounded_up(delta / (mu - delta), 20)))
        degrees = rounded_up(Fraction(root) * Fraction("114.591559027"), 2)  # 360/pi = ...026...
        yield f"Every global optimum is within {degrees:.1e} degrees of R."
    if pattern[0] == 1:
        yield "The global optimum is unique: every other rotation has a larger objective."
    else:
        yield f"The global optimum is NOT unique: the optima form {KINDS[pattern[0]]}."
    kinds = ", ".join(KINDS[k] for k in pattern)
    counts = ", ".join(map(str, [0, *accumulate(pattern[:-1])]))
    if solid:
        yield "The moving cloud has three noncollinear points of positive weight (J > 0)."
        yield f"The equilibria of the dynamics: {kinds}; unstable directions: {counts}."
    else:
        yield "The moving points are collinear (J is singular): the dynamics is not defined."
        yield f"The critical rotations: {kinds}; directions of descent: {counts}."
    if fields["sdp_gap"] is not None:
        yield f"The relaxation's dual bounds that gap by {rounded_up(fields['sdp_gap'], 2):.1e}."
    if fields["basin"]:
        yield "A body moving from the state `basin` ends at the optimum, whatever the damping > 0."
    yield "Not proved: anything under `about`, and where the points come from."


# --- kind: count --------------------------------------------------------------------------------
# Claims: at most four rotations are at equilibrium. It is about the torque of the springs alone.

COUNT_KEYS = {
    "": "about claims format kind problem proof",
    "claims": "at_most",
    "problem": "data digest n",
    "proof": "chart modulus",
}
SCALARS.update({"at_most": int, "modulus": int})
MODULUS_MAX = 2**64  # bounds the time; larger ones prove nothing more
PAIRS = [(i, j) for i in range(4) for j in range(i, 4)]  # the ten monomials q_i q_j


def rotation_coefficient(i: int, j: int) -> Matrix:
    """3x3 integer matrix: the coefficient of q_i q_j, i <= j, in |q|^2 R(q).

    |q|^2 R(q) = (w^2 - x^2 - y^2 - z^2) I + 2 v v^T + 2 w [v], v = (x, y, z), [v] u = v x u.
    """
    A = [[(i == j) * (1 if i == 0 else -1) * (a == b) for b in range(3)] for a in range(3)]
    if i > 0:
        A[i - 1][j - 1] += 2
        A[j - 1][i - 1] += 2 * (i != j)
    elif j > 0:
        a, b = j % 3, (j + 1) % 3  # [e_j] takes e_a to e_b
        A[b][a], A[a][b] = 2, -2
    return A


def torques(A: Matrix, C: Matrix) -> list[int]:
    """The six entries of A^T C - C^T A and A C^T - C A^T above the diagonal.

    For a rotation A = R they vanish iff the torque of the springs does: it is twice the first three
    in the body's frame, twice the last three in the world's, up to order and sign.
    """
    found: list[int] = []
    for one, other in ((list(zip(*A)), list(zip(*C))), (A, C)):  # noqa: B905 (3.9)
        product = [[sum(map(mul, row, column)) for column in other] for row in one]
        found += [product[i][j] - product[j][i] for i in range(3) for j in range(i + 1, 3)]
    return found


def has_full_rank(rows: Matrix, modulus: int) -> bool:
    """Whether a square integer matrix is invertible modulo the modulus: then it is over Q.

    Every pivot has an inverse, so the determinant is a unit modulo the modulus and is not zero;
    whether the modulus is a prime does not matter.
    """
    rows = [[entry % modulus for entry in row] for row in rows]
    for k in range(len(rows)):
        pivot = next((row for row in rows[k:] if gcd(row[k], modulus) == 1), None)
        if pivot is None:
            return False
        rows.remove(pivot)
        rows.insert(k, pivot)
        inverse = pow(pivot[k], -1, modulus)
        for row in rows[k + 1 :]:
            factor = row[k] * inverse
            row[:] = [(a - factor * b) % modulus for a, b in zip(row, pivot)]  # noqa: B905
    return True


def _prove_count(fields: dict[str, Any], m: Matrix, _: int) -> tuple[str, ...]:
    """The six torques of R(q) and the four q_i (a . q), a = chart, are quadratic forms in q.

    If their 10x10 coefficients are of full rank, every q_i q_j is a combination of the ten. At an
    equilibrium with a . q = 1 so every q_i q_j is a fixed combination of the q_i: the polynomials
    modulo the equations are spanned by four, and there are at most four solutions, complex ones and
    multiplicities counted. With a . q = 0 every q_i q_j, so q, would be 0. And q and -q, of which
    one at most has a . q = 1 when scaled, are the same rotation.
    """
    n, chart, modulus = fields["n"], fields["chart"], fields["modulus"]
    require(m[0][0] > 0, "no weight is positive")
    require(1 < modulus < MODULUS_MAX, "proof.modulus is out of range")
    C = [[m[0][0] * m[k][j] - m[0][k] * m[0][j] for k in (1, 2, 3)] for j in (4, 5, 6)]
    columns = [torques(rotation_coefficient(i, j), C) for i, j in PAIRS]
    for (i, j), column in zip(PAIRS, columns):  # noqa: B905 (3.9)
        column += [chart[j] * (i == k) + chart[i] * (j == k and i != j) for k in range(4)]
    require(has_full_rank(columns, modulus), "proof does not show the quadratics independent")
    require(fields["at_most"] >= 4, "claims.at_most is below the proved bound 4")
    return (
        f"Data: n = {n} pairs. SHA-256 of their doubles is {fields['digest']}.",
        "At most four rotations are at equilibrium: at all others the springs exert a torque.",
        "Complex solutions and multiplicities are counted in.",
        "Not proved: anything under `about`, and where the points come from.",
    )


FORMS: Any = {"isotropic": (KEYS, _prove), "count": (COUNT_KEYS, _prove_count)}
# --- end of kind: count -------------------------------------------------------------------------


def rounded_up(value: Fraction, digits: int) -> Decimal:
    """Least decimal number of so many digits that is at least the value > 0."""
    context = Context(prec=digits, rounding=ROUND_CEILING)
    return context.divide(Decimal(value.numerator), Decimal(value.denominator))


def shown(text: object) -> str:
    """Text from outside made printable: ASCII, escaped, of bounded length."""
    return ascii(str(text)[:200])[1:-1]


def main(argv: list[str]) -> int:
    """Exit code: 0 verified, 1 refused, 2 unreadable file or wrong usage."""
    if len(argv) != 1 or argv[0].startswith("-"):
        sys.stderr.write("usage: verify.py CERTIFICATE (a JSON file that holds its points)\n")
        return 0 if argv == ["--help"] else 2
    try:
        with Path(argv[0]).open("rb") as file:
            outcome = check(file.read(FILE_MAX + 1))
    except (OSError, ValueError) as error:
        sys.stderr.write(f"{shown(argv[0])}: {shown(error)}: give a readable file\n")
        return 2
    verdict = "VERIFIED" if outcome.verified else f"REFUSED: {outcome.reason}"
    print(*outcome.theorems, verdict, sep="\n")
    return 0 if outcome.verified else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
