"""What the checker must say of general springs just inside and just outside of its inequalities.

Cases as those of `checker_boundaries`. What is right is found here by exact fractions from the
problem's objective, which shares no formula with the checker.
"""

from __future__ import annotations

import base64
import copy
import hashlib
import json
import re
import struct
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from functools import cache
from itertools import chain, combinations_with_replacement
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
from checker_boundaries import Case, outcome_of, value_of
from springs_certified import certificate_of, certified

from certreg.exact.elimination import is_positive_definite
from certreg.problem.problem import RegistrationProblem

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


Document = dict[str, Any]
PREFIX = b"certreg-springs/1\0"
QUARTICS = [*combinations_with_replacement(range(4), 4)]
PRODUCTS = [*combinations_with_replacement(range(4), 2)]
UNPROVED = "REFUSED: level, mu and gram do not prove the pose optimal$"
RANGES = "REFUSED: mu >= 0, a pose other than 0 and small exponents needed$"
LARGE = "REFUSED: a number of the proof has too many bits$"
TWO = Fraction(2)


@cache
def good() -> Document:
    """Of eight planes."""
    return json.loads(certified("plane", 8, 1.0).certificate.to_json())


@cache
def still() -> Document:
    """Of eight planes and no translation, far from the origin, with a radius."""
    rng = np.random.default_rng(5)
    source = 0.3 * rng.normal(size=(8, 3)) + [3.0, 0.0, 0.0]
    normals, target = rng.normal(size=(8, 3)), source + 0.5 * rng.normal(size=(8, 3))
    problem = RegistrationProblem(source, target, normals=normals, rotation_only=True)
    return json.loads(certificate_of(problem, robustness_angle=5.0).to_json())


def of_still() -> Iterator[tuple[str, Document, str]]:
    """Without a translation: what is eliminated, and about what the radius is."""
    radius, words = still()["radius"], "REFUSED: radius is larger than what is proved$"
    yield "no translation", still(), "VERIFIED.*objective at R, no translation"
    for name in ("target", "both"):
        mantissa, exponent = radius[name]
        larger = {**radius, name: [mantissa + (mantissa >> 5), exponent]}
        yield f"no translation, {name} too large", {**still(), "radius": larger}, words
    unsaid = {name: value for name, value in still().items() if name != "rotation_only"}
    yield "no translation, not said", unsaid, "REFUSED: data is not"
    yield "a translation, not so said", {**good(), "rotation_only": True}, "REFUSED: data is not"


def other(document: Any = None, **entries: Any) -> Document:
    """With other entries, of claims and proof."""
    found = copy.deepcopy(document or good())
    for name, value in entries.items():
        next(found[part] for part in ("claims", "proof") if name in found[part])[name] = value
    return found


def bare(**entries: Any) -> Document:
    """With other entries, and claims that hold of any proof but for the gap."""
    return other(other(sin2_half_angle=None, unique=None, gap=[1, 60]), **entries)


def about(source: Any, target: Any, factors: Any, document: Document | None = None) -> Document:
    """The same of other data."""
    rows = [np.asarray(part, dtype=float).ravel().tolist() for part in (source, target, factors)]
    n = len(rows[0]) // 3
    numbers = [*chain(*rows)]
    content = PREFIX + struct.pack(f"<Q{len(numbers)}d", n, *numbers)
    data = base64.b64encode(content).decode()
    problem = {"data": data, "digest": hashlib.sha256(content).hexdigest(), "n": n}
    return {**(document or good()), "problem": problem}


def quartic() -> list[Fraction]:
    """Of the objective, exactly."""
    objective = certified("plane", 8, 1.0).objective
    return [c * objective.unit for c in objective.quartic]


def at(q: list[int]) -> Fraction:
    """The objective at a quaternion."""
    norm = sum(c * c for c in q)
    powers = zip(quartic(), QUARTICS, strict=True)
    return sum(c * q[i] * q[j] * q[k] * q[m] for c, (i, j, k, m) in powers) / Fraction(norm**2)


def loss(level: int, proof: Document) -> Fraction:
    """Delta of a level."""
    return at(proof["pose"]) - (level - 70) * TWO ** proof["unit"]


def lowest(holds: Callable[[int], bool], top: int, steps: int = 200) -> int:
    """The lowest level at which something holds that does at the top."""
    assert holds(top)
    step = 1
    while holds(top - step):
        step *= 2
        assert step.bit_length() < steps
    low, high = top - step, top
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


def pair(value: Fraction, up: int) -> list[int]:
    """A dyadic of 200 bits, at least the value or below it."""
    e = value.numerator.bit_length() - value.denominator.bit_length() - 200
    mantissa = value / TWO**e
    return [-int(-mantissa // 1) if up else int(-(-mantissa // 1)) - 1, e]


def is_definite(document: Document) -> bool:
    """Whether the Gram matrix of a proof is positive definite, in fractions."""
    proof = document["proof"]
    unit, q = TWO ** proof["unit"], proof["pose"]
    norm, mu = sum(c * c for c in q) ** 2, proof["mu"]
    left: dict[tuple[int, ...], Fraction] = {}
    for c, m in zip(quartic(), QUARTICS, strict=True):
        times = 24
        for k in range(4):
            times //= (1, 1, 2, 6, 24)[m.count(k)]
        along = times * mu * q[m[0]] * q[m[1]] * q[m[2]] * q[m[3]]
        left[m] = Fraction(c // unit + along // norm)
    both = combinations_with_replacement(PRODUCTS, 2)
    places = [tuple(sorted((*one, *another))) for one, another in both]
    free = iter([g << proof["gram"][-1] for g in proof["gram"][:-1]])
    first: dict[tuple[int, ...], tuple[int, int]] = {}
    A = [[Fraction(0)] * 10 for _ in range(10)]
    for (i, j), m in zip(combinations_with_replacement(range(10), 2), places, strict=True):
        if m in first:
            A[i][j] = Fraction(next(free))
            left[m] -= A[i][j]
        else:
            first[m] = (i, j)
    for m, (i, j) in first.items():
        A[i][j] = left[m]
    for i in range(10):
        A[i][i] = 2 * (A[i][i] - (proof["level"] + mu) * (1 + (PRODUCTS[i][0] != PRODUCTS[i][1])))
    return is_positive_definite([[int(entry) for entry in row] for row in A])


def width(level: int) -> int:
    """As the checker bounds the range of the objective, over 2^unit."""
    unit = TWO ** good()["proof"]["unit"]
    square = [(1 if m[0] == m[3] else 2) * (m[0] == m[1] and m[2] == m[3]) for m in QUARTICS]
    parts = zip(quartic(), square, strict=True)
    return sum(abs(c // unit - level * k) for c, k in parts) + 140


def questions() -> Iterator[tuple[str, Document, str]]:
    """Name, certificate, and what the answer begins with."""
    proof, claims = good()["proof"], good()["claims"]
    level, mu, unit = proof["level"], proof["mu"], TWO ** proof["unit"]
    delta = loss(level, proof)
    yield "accepted", good(), "VERIFIED"
    yield from of_still()
    for name, bound in (("gap", delta), ("sin2_half_angle", delta / (mu * unit))):
        yield f"{name} inside", other(**{name: pair(bound, 1)}), "VERIFIED"
        yield f"{name} outside", other(**{name: pair(bound, 0)}), f"REFUSED: claims.{name} is not"
    high = -lowest(lambda k: is_definite(bare(level=-k)), -level)
    yield "level inside", bare(level=high), "VERIFIED"
    yield "level outside", bare(level=high + 1), UNPROVED

    def single(k: int) -> bool:
        return 4 * max(width(k), 2 * mu) * loss(k, proof) <= mu**2 * unit

    low = lowest(single, level)
    yield "unique inside", bare(level=low, unique=True), "VERIFIED"
    yield "unique outside", bare(level=low - 1, unique=True), "REFUSED: claims.unique is not proved"
    low = lowest(lambda k: 10 * loss(k, proof) < 7 * mu * unit, level)
    yield "angle inside", bare(level=low), "VERIFIED.*Every global optimum is within"
    yield "angle outside", bare(level=low - 1), "VERIFIED.*No angle is bounded"
    mean = (
        sum(
            c * (3 if m[0] == m[3] else m[0] == m[1] and m[2] == m[3])
            for c, m in zip(quartic(), QUARTICS, strict=True)
        )
        / 24
    )
    low = lowest(lambda k: loss(k, proof) < mean - at(proof["pose"]), level)
    yield "share inside", bare(level=low), r"VERIFIED.*gap is less than 1\.0e\+0 of the range"
    yield (
        "share outside",
        bare(level=low - 1),
        r"VERIFIED.*is at least 0\..*gap bounds nothing: not proved to be",
    )
    yield "no growth", bare(mu=0, level=level - 2 * mu), "VERIFIED.*No angle.*unique or not"
    yield "growth below 0", bare(mu=-1), RANGES
    yield "no pose", bare(pose=[0] * 4), RANGES
    gram = proof["gram"]
    for name, inside, outside in (("shift", 256, 257), ("shift below", 0, -1)):
        yield f"{name} inside", bare(gram=[*gram[:-1], inside]), UNPROVED
        yield f"{name} outside", bare(gram=[*gram[:-1], outside]), RANGES
    yield (
        "unit inside",
        bare(unit=32768, level=-1, mu=0, gram=[0] * 21, gap=[128, 32768]),
        "VERIFIED",
    )
    yield "unit outside", bare(unit=32769, level=-1, mu=0, gram=[0] * 21), RANGES
    yield "unit outside, below", bare(unit=-32769), RANGES
    yield "F too large", bare(unit=proof["unit"] - 200), LARGE
    for name in ("level", "mu"):
        yield f"{name} of 256 bits", bare(**{name: 2**256 - 1}), UNPROVED
        yield f"{name} of 257 bits", bare(**{name: 2**256}), LARGE
    yield "level far below", bare(level=-(2**256) + 1, gap=[1, 300]), "VERIFIED"
    yield "level too far below", bare(level=-(2**256)), LARGE
    yield "gram of 257 bits", bare(gram=[2**256, *gram[1:]]), LARGE
    yield "gram of 256 bits", bare(gram=[2**256 - 1, *gram[1:]]), UNPROVED
    yield "unsaid", other(unique=None), "VERIFIED.*is unique or not: that is undecided"
    yield "said", good(), "VERIFIED.*is unique: every other rotation has a larger objective"
    yield "said wrongly", other(unique=False), "REFUSED: claims.unique is not proved"
    assert claims["unique"] is True
    yield from _other_data()


def _other_data() -> Iterator[tuple[str, Document, str]]:
    points = np.eye(3)
    ones = np.tile([1.0, 0.0, 1.0, 0.0, 0.0, 1.0], (3, 1))
    trivial = bare(level=-1, mu=0, gram=[0] * 21, unit=2000, gap=[1, 2100])
    yield "no springs", about(points, points, 0 * ones, trivial), "REFUSED: all springs are 0$"
    few = np.array([[1.0, 0.0, 0.0, 0.0, 0.0, 0.0], *0 * ones[1:]])
    yield "one spring", about(points, points, few, trivial), "VERIFIED.*cost nothing: 2"
    one = about(points[:1], 2 * points[:1], ones[:1], trivial)
    yield "one point", one, "VERIFIED.*range of energies is 0: every rotation is optimal"
    yield "a corner", about(points, points, ones, trivial), "VERIFIED.*cost nothing: 0"
    for name, power, answer in (
        ("inside", 768, "VERIFIED"),
        ("outside", 769, "REFUSED: the data hold numbers of too many sizes"),
    ):
        wide = ones.copy()
        wide[0, 0] = 2.0**-power
        yield f"sizes of factors, {name}", about(points, points, wide, trivial), answer
        wide = ones * 2.0 ** (power - 1)
        wide[0, 0] = 0.5
        yield f"sizes of more factors, {name}", about(points, points, wide, trivial), answer
        far = points * 2.0 ** (power + 52)
        yield (
            f"sizes of points, {name}",
            about(far, far, ones, {**trivial, "claims": {**trivial["claims"], "gap": [1, 2100]}}),
            answer,
        )
    octahedron = np.concatenate([points, -points]) * [2.0, 1.0, 1.0]
    symmetric = RegistrationProblem(octahedron, octahedron, factors=np.tile(ones[0], (6, 1)))
    certificate = certificate_of(symmetric)
    document = json.loads(certificate.to_json())
    document["claims"]["unique"] = False
    unmoved = other(document, symmetry=[1, 0, 0, -1, 0, 0])
    yield "a symmetry that leaves the optimum", unmoved, "REFUSED: claims.unique is not proved"
    one_wall = RegistrationProblem(octahedron, octahedron + 0.25, normals=[[1.0, 2.0, 2.0]] * 6)
    document = json.loads(certificate_of(one_wall).to_json())
    assert document["claims"]["unique"] is False
    yield "a symmetry", document, "VERIFIED.*is NOT unique: other rotations have the same objective"
    for turns in ([0] * 6, [1, 2, 2, 1, 2, 2], [1, 2, 3, 0, 0, 0], [0, 0, 0, 1, 2, 2], None):
        wrong = other(document, symmetry=turns)
        yield f"symmetry {turns}", wrong, "REFUSED: claims.unique is not proved"


def direct_questions() -> Iterator[tuple[str, Callable[[Any], object], str]]:
    """Of functions of the checker: what no data lead to, or what only some show."""
    entries: dict[str, Any] = dict(  # noqa: C408  (names, as in the certificate)
        pose=(1, 0, 0, 0),
        gap=Fraction(9),
        sin2_half_angle=None,
        unique=True,
        rotation_only=None,
        symmetry=None,
        n=1,
        digest="",
        steady_by_growth=lambda *_: (),
    )

    def settled(checker: Any, delta: Fraction, mu: int = 1, **claims: Any) -> bool:
        F = [0] * 34 + [1]
        springs = checker.CheckedSprings(F, Fraction(1), 0, Fraction(1), Fraction(1))
        stated = SimpleNamespace(**{**entries, **claims})
        try:
            return checker.settled(stated, springs, delta, Fraction(mu), Fraction(1)).verified
        except checker.RefusalError:
            return False

    eighth = Fraction(1, 8)
    yield "no loss, no growth", lambda c: settled(c, Fraction(0), 0), "False"
    half = {"unique": None, "sin2_half_angle": Fraction(1, 2)}
    yield "no loss, no growth, an angle", lambda c: settled(c, Fraction(0), 0, **half), "False"
    yield "range at least 2 mu, inside", lambda c: settled(c, eighth), "True"
    yield "range at least 2 mu, outside", lambda c: settled(c, eighth + Fraction(1, 10**9)), "False"

    def in_blocks(checker: Any) -> str:
        size, checker.BLOCK = checker.BLOCK, 3
        try:
            return repr(checker.check(json.dumps(good()).encode()).theorems)
        finally:
            checker.BLOCK = size

    yield (
        "in blocks",
        lambda c: in_blocks(c) == repr(c.check(json.dumps(good()).encode()).theorems),
        "True",
    )
    proof = good()["proof"]
    steep = proof["mu"] * TWO ** proof["unit"]
    low = lowest(lambda k: 10 * loss(k, proof) < 7 * steep, proof["level"])
    for name, document in (("worth", good()), ("worth of a loose bound", bare(level=low))):
        yield name, lambda c, document=document: is_exact(c, document), "True"


def is_exact(checker: Any, document: Document) -> bool:
    """Whether the worth of a certificate of the good one's data is what fractions say."""
    found, proof = checker.check(json.dumps(document).encode()).worth, document["proof"]
    delta, value = loss(proof["level"], proof), at(proof["pose"])
    factors = certified("plane", 8, 1.0).problem.factors
    weight = Fraction(sum(float(k) ** 2 for k in factors.ravel()))
    s = delta / (proof["mu"] * TWO ** proof["unit"])
    bounds = ((found.angle**2 * (1 - s), 4 * s), (found.length**2 * found.weight, delta))
    tight = all(low < bound < low * (1 + Fraction(1, 2**60)) for bound, low in bounds)
    same = (found.objective, found.gap, found.minimum) == (value, delta, max(value - delta, 0))
    return tight and same and abs(3 * found.weight - weight) < Fraction(1, 10**9)


def words() -> str:
    """The pattern of all theorems of the good certificate."""
    case = certified("plane", 8, 1.0)
    q = good()["proof"]["pose"]
    unit = np.array([float(c) for c in q]) / float(sum(c * c for c in q)) ** 0.5
    value, delta = at(q), loss(good()["proof"]["level"], good()["proof"])
    up, down = (
        f"{Context(prec=12, rounding=way).divide(*map(Decimal, x.as_integer_ratio())):g}"
        for x, way in ((value, ROUND_CEILING), (value - delta, ROUND_FLOOR))
    )
    told = ", ".join(f"{c:.12f}" for c in unit)
    lines = [
        "VERIFIED",
        "Data: n = 8 pairs, each with a matrix W of springs.",
        f"SHA-256 of their doubles is {case.problem.digest()}.",
        f"The certified rotation R is that of the quaternion ({told}), rounded here; w first.",
    ]
    text = re.escape("\n".join(lines))
    return text + (
        r"\nSum of tr W / 3: 2\.66666666667; objective at R, best translation: "
        f"{re.escape(up)}; both rounded up\\."
        r"\nIndependent directions of shifts that cost nothing: 0\."
        r"\nThe objective at R exceeds the global minimum by less than \d\.\de-\d\d "
        r"\(sum of r\^T W r\)\."
        f"\nSo the minimum is at least {re.escape(down)}\\."
        r"\nThis gap is less than \d\.\de-\d\d of the range of energies, over all rotations\."
        r"\nEvery global optimum is within \d\.\de-\d\d degrees of R\."
        r"\nThe rotation of the global optimum is unique: every other rotation has a larger "
        r"objective\."
        r"\nNot proved: anything under `about`, and where the points come from\.$"
    )


@cache
def _cases() -> tuple[Case, ...]:
    made = [Case(name, outcome_of(document), answer) for name, document, answer in questions()]
    made += [Case(name, value_of(ask), f"{answer}$") for name, ask, answer in direct_questions()]
    return (Case("words", outcome_of(good()), words()), *made)


def springs_cases() -> list[Case]:
    """All cases of general springs."""
    return list(_cases())
