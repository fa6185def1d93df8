"""Every printed bound beside an exact oracle, on 5,000 random problems.

A bound is read where a user reads it: in the JSON, in the text of the terminal, on the page, in the
checker's sentences, in the certificate. The oracle shares nothing with the package: points as
fractions, Kabsch's singular values as roots of an integer polynomial that FLINT isolates, the best
rotation by Markley's FOAM [Markley1993] in ball arithmetic of 3,000 bits.
"""

from __future__ import annotations

import html
import json
import re
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

import flint
import numpy as np
from commands import checked
from strategies import ZOO, random_rotation

from certreg.errors import OutOfRangeError
from certreg.problem.problem import RegistrationProblem
from certreg.registration.assessment import assess
from certreg.registration.certification import certify
from certreg.report.document import result_document
from certreg.report.judged_pose import assessment_document, assessment_summary
from certreg.report.page import Report
from certreg.report.pages import html_page
from certreg.report.summary import registration_summary

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from certreg.registration.assessment import Assessment
    from certreg.registration.result import Registration


PROBLEMS = 5000
BITS = 3000  # of a ball: singular values and angles 100 decades apart are told
DEGREES = Fraction(180)
Matrix = list[list[Any]]


# The oracle --------------------------------------------------------------------------------------


def ball(value: Fraction | int) -> Any:
    exact = Fraction(value)
    return flint.arb(flint.fmpq(exact.numerator, exact.denominator))


def rows(array: Any) -> Matrix:
    return [[Fraction(entry) for entry in row] for row in np.asarray(array, dtype=float).tolist()]


def product(A: Matrix, B: Matrix) -> Matrix:
    return [
        [sum(a * b for a, b in zip(r, c, strict=True)) for c in zip(*B, strict=True)] for r in A
    ]


def transpose(A: Matrix) -> Matrix:
    return [list(column) for column in zip(*A, strict=True)]


def det(A: Matrix) -> Any:
    (a, b, c), (d, e, f), (g, h, i) = A
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def cofactors(A: Matrix) -> Matrix:
    return [
        [
            A[(i + 1) % 3][(j + 1) % 3] * A[(i + 2) % 3][(j + 2) % 3]
            - A[(i + 1) % 3][(j + 2) % 3] * A[(i + 2) % 3][(j + 1) % 3]
            for j in range(3)
        ]
        for i in range(3)
    ]


def rotation(q: Sequence[Fraction]) -> Matrix:
    """The rotation of a quaternion, normalised, w first."""
    w, x, y, z = q
    n = w * w + x * x + y * y + z * z
    return [
        [(w * w + x * x - y * y - z * z) / n, 2 * (x * y - w * z) / n, 2 * (x * z + w * y) / n],
        [2 * (x * y + w * z) / n, (w * w - x * x + y * y - z * z) / n, 2 * (y * z - w * x) / n],
        [2 * (x * z - w * y) / n, 2 * (y * z + w * x) / n, (w * w - x * x - y * y + z * z) / n],
    ]


@dataclass(frozen=True)
class Oracle:
    """What is true of a problem, exactly or in balls of the precision that FLINT is set to."""

    source: Matrix
    target: Matrix
    weights: list[Fraction]
    known: dict[Any, Any] = field(default_factory=dict)  # gaps and angles of poses

    @classmethod
    def of(cls, problem: RegistrationProblem) -> Oracle:
        weights = [Fraction(w) for w in np.asarray(problem.weights, dtype=float).tolist()]
        return cls(rows(problem.source), rows(problem.target), weights)

    @cached_property
    def mass(self) -> Fraction:
        return sum(self.weights, Fraction(0))

    def mean(self, points: Matrix) -> list[Fraction]:
        pairs = list(zip(self.weights, points, strict=True))
        return [sum((w * p[k] for w, p in pairs), Fraction(0)) / self.mass for k in range(3)]

    @cached_property
    def centred(self) -> tuple[Matrix, Matrix]:
        x, y = self.mean(self.source), self.mean(self.target)
        return (
            [[a - b for a, b in zip(p, x, strict=True)] for p in self.source],
            [[a - b for a, b in zip(p, y, strict=True)] for p in self.target],
        )

    @cached_property
    def C(self) -> Matrix:
        x, y = self.centred
        weighted = [[w * a for a in p] for w, p in zip(self.weights, y, strict=True)]
        return product(transpose(weighted), x)

    @cached_property
    def spread(self) -> Fraction:
        parts = zip(self.weights, *self.centred, strict=True)
        return sum((w * sum(a * a for a in (*x, *y)) for w, x, y in parts), Fraction(0))

    @cached_property
    def singular(self) -> list[Any]:
        """The singular values of C, falling, as balls; the last has the sign of det C."""
        S = product(transpose(self.C), self.C)
        e1 = S[0][0] + S[1][1] + S[2][2]
        e2 = sum((cofactors(S)[k][k] for k in range(3)), Fraction(0))
        polynomial = flint.fmpq_poly([_fmpq(-det(S)), _fmpq(e2), _fmpq(-e1), flint.fmpq(1)])
        isolated: Any = polynomial.numer().complex_roots()
        roots = [r.real for r, times in isolated for _ in range(times)]
        d = sorted((r.sqrt() if r > 0 else flint.arb(0) for r in roots), key=_middle, reverse=True)
        return [d[0], d[1], -d[2] if det(self.C) < 0 else d[2]]

    @cached_property
    def best(self) -> Any:
        """The largest tr(R^T C) over all rotations."""
        return sum(self.singular)

    @property
    def minimum(self) -> Any:
        return ball(self.spread) - 2 * self.best

    @property
    def energy_range(self) -> Any:
        """Of the objective over all rotations: 2 (l1 - l4) = 4 (d1 + d2)."""
        return 4 * (self.singular[0] + self.singular[1])

    @cached_property
    def unique(self) -> bool:
        """d2 + d3 > 0, decided exactly: it is zero iff C has rank one, or det C < 0 and d2 = d3."""
        if all(entry == 0 for row in cofactors(self.C) for entry in row):
            return False
        d = self.singular
        return det(self.C) >= 0 or not (d[1] + d[2]).overlaps(flint.arb(0))

    @cached_property
    def optimum(self) -> Matrix:
        """R = ((kappa + |C|^2) C + lambda adj(C)^T - C C^T C) / zeta, where it is unique."""
        C, best = [[ball(entry) for entry in row] for row in self.C], self.best
        square = sum(entry * entry for row in C for entry in row)
        kappa = (best * best - square) / 2
        zeta = kappa * best - ball(det(self.C))
        cubic, adjugate = product(product(C, transpose(C)), C), cofactors(C)
        return [
            [
                ((kappa + square) * C[i][j] + best * adjugate[i][j] - cubic[i][j]) / zeta
                for j in range(3)
            ]
            for i in range(3)
        ]

    def objective(self, q: Sequence[Fraction], t: Sequence[Fraction] | None = None) -> Fraction:
        """The sum over the points as it is written down; t: the best one if there is none."""
        R = rotation(q)
        if t is None:
            x, y = self.mean(self.source), self.mean(self.target)
            t = [b - a for a, b in zip(_applied(R, x), y, strict=True)]
        total = Fraction(0)
        for w, x, y in zip(self.weights, self.source, self.target, strict=True):
            parts = zip(y, _applied(R, x), t, strict=True)
            total += w * sum((b - a - c) ** 2 for b, a, c in parts)
        return total

    def gap(self, q: Sequence[Fraction], t: Sequence[Fraction] | None = None) -> Any:
        """The objective of a pose above the minimum."""
        key = (tuple(q), None if t is None else tuple(t))
        if key not in self.known:
            self.known[key] = self._gap(q, t)
        return self.known[key]

    def _gap(self, q: Sequence[Fraction], t: Sequence[Fraction] | None) -> Any:
        if not any(entry for row in self.C for entry in row):
            return ball(self.objective(q, t) - self.spread)
        return ball(self.objective(q, t)) - self.minimum

    def angle(self, q: Sequence[Fraction]) -> Any:
        """Radians from a rotation to the one best: 4 sin^2(a/2) = 3 - tr(R*^T R)."""
        if tuple(q) not in self.known:
            self.known[tuple(q)] = self._angle(q)
        return self.known[tuple(q)]

    def _angle(self, q: Sequence[Fraction]) -> Any:
        R = [[ball(entry) for entry in row] for row in rotation(q)]
        trace = sum(
            a * b for r, s in zip(self.optimum, R, strict=True) for a, b in zip(r, s, strict=True)
        )
        return 2 * root((3 - trace) / 4).asin()


def root(square: Any) -> Any:
    """Of what is not negative: where a ball may be zero, a ball about zero."""
    return square.sqrt() if square > 0 else flint.arb(0, square.abs_upper().sqrt())


def _fmpq(value: Fraction) -> Any:
    return flint.fmpq(value.numerator, value.denominator)


def _middle(value: Any) -> Any:
    return value.mid()


def _applied(R: Matrix, x: Sequence[Fraction]) -> list[Fraction]:
    return [sum((a * b for a, b in zip(row, x, strict=True)), Fraction(0)) for row in R]


# What users read ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Bound:
    """A number that is printed as a bound, and what it bounds."""

    place: str
    printed: Fraction
    true: Any
    lower: bool = False

    @property
    def kind(self) -> str:
        """Where it stands, without its number."""
        return re.sub(NUMBER, "#", self.place).strip()

    def holds(self) -> bool:
        if self.printed == 0 and self.lower:
            return True  # of what is never negative
        with flint.ctx.workprec(BITS):
            bound = ball(self.printed)
            return bool(bound <= self.true) if self.lower else bool(bound >= self.true)


NUMBER = r"([-+0-9.eE]*[0-9])"
GAP, ANGLE, SHARE = "gap", "angle", "share"
READ_POSE = (  # in the terminal and on the page, of the pose printed there
    (rf"objective - minimum <= {NUMBER}", GAP),
    (rf"objective - minimum <= \S+ {NUMBER} (?:of|times) the range", SHARE),
    (rf"within {NUMBER} of the minimum", GAP),
    (rf"of the minimum \({NUMBER} (?:of|times) the range", SHARE),
    (rf"within {NUMBER} degrees of the (?:one )?optimum", ANGLE),
    (rf"exceeds the minimum by at most {NUMBER}\.", GAP),
    (rf"≤ {NUMBER} of the objective above the global minimum", GAP),
    (rf"above the global minimum: {NUMBER} (?:of|times) the range", SHARE),
    (rf"given below is within {NUMBER} degrees of it", ANGLE),
)
READ_DUAL = (
    rf"which alone proves a gap of at most {NUMBER}(?:, which bounds nothing)?(?:\n|$)",
    rf"bounds the gap of the certified rotation independently: at most {NUMBER}\.",
)
READ_CHECKER = (
    (rf"exceeds the global minimum by less than {NUMBER} ", GAP),
    (rf"This gap is less than {NUMBER} of the range", SHARE),
    (rf"Every global optimum is within {NUMBER} degrees of R", ANGLE),
    (rf"The relaxation's dual bounds that gap by {NUMBER}[.:]", GAP),
)


def read(patterns: Sequence[tuple[str, str]], text: str) -> Iterator[tuple[str, str, Fraction]]:
    """The sentence that holds a number, what it bounds, and the number."""
    for pattern, kind in patterns:
        for match in re.finditer(pattern, text, re.IGNORECASE):
            yield match[0], kind, Fraction(Decimal(match[1]))


def seen(page: bytes) -> str:
    """The words of a page without its data, as a reader sees them."""
    text = re.sub(r"<(script|style)\b.*?</\1>", " ", page.decode(), flags=re.DOTALL)
    return re.sub(r"\s+", " ", html.unescape(re.sub(r"<[^>]*>", " ", text)))


@dataclass
class Reader:
    """All bounds that are printed of one problem."""

    oracle: Oracle
    bounds: list[Bound] = field(default_factory=list)

    def add(self, place: str, printed: Any, true: Any, *, lower: bool = False) -> None:
        if printed is not None:
            self.bounds.append(Bound(place, Fraction(printed), true, lower))

    def pose(self, place: str, text: str, q: list[Fraction], t: list[Fraction] | None) -> None:
        """What a text says of a pose: t is None for a rotation with the best translation."""
        patterns = READ_POSE if t is not None else READ_CHECKER
        for words, kind, number in read(patterns, text):
            self.add(f"{place}: {words}", *self.told(kind, number, q, t))

    def told(
        self, kind: str, number: Fraction, q: list[Fraction], t: list[Fraction] | None
    ) -> tuple[Fraction, Any]:
        oracle = self.oracle
        if kind == ANGLE:
            return number, oracle.angle(q) * DEGREES.numerator / flint.arb.pi()
        gap = oracle.gap(q, t)
        return number, gap if kind == GAP else gap / oracle.energy_range

    def registration(self, registration: Registration) -> None:
        """The JSON, the terminal, the page, the certificate and the checker's sentences."""
        oracle, document = self.oracle, json.loads(json.dumps(result_document(registration)))
        q, t = (
            doubles(document["pose"]["quaternion_wxyz"]),
            doubles(document["pose"]["translation"]),
        )
        stated, gap = document["optimality"], oracle.gap(q, t)
        self.add("JSON gap_bound", stated["gap_bound"], gap)
        if stated["gap_share"] is not None:
            self.add("JSON gap_share", stated["gap_share"], gap / oracle.energy_range)
        if stated["angle_bound_rad"] is not None:
            self.add("JSON angle_bound_rad", stated["angle_bound_rad"], oracle.angle(q))
        assert stated["unique"] == oracle.unique
        terminal, page = registration_summary(registration), ""
        self.pose("terminal", terminal, q, t)
        if registration.certificate is not None:
            page = seen(html_page(Report.of(registration)))
            self.pose("page", page, q, t)
            self.certified(registration, document, terminal + page)

    def certified(self, registration: Registration, document: dict[str, Any], text: str) -> None:
        """What is said of the certified rotation R, with its best translation."""
        oracle, certificate = self.oracle, json.loads(checked(registration.certificate).to_json())
        r = [Fraction(entry) for entry in certificate["pose"]]
        gap, claims = oracle.gap(r), certificate["claims"]
        self.add("certificate gap", dyadic(claims["gap"]), gap)
        self.add("certificate sdp_gap", dyadic(claims["sdp_gap"]), gap)
        if claims["sin2_half_angle"] is not None:
            sine = (oracle.angle(r) / 2).sin()
            self.add("certificate sin2", dyadic(claims["sin2_half_angle"]), sine * sine)
        dual = (document["relaxation"] or {}).get("proved_gap")
        self.add("JSON proved_gap", dual, gap)
        for words, _, number in read([(pattern, GAP) for pattern in READ_DUAL], text):
            self.add(f"dual: {words}", number, gap)
        said = "\n".join(checked(registration.verdict).theorems)
        self.pose("checker", said, r, None)
        for match in re.finditer(
            rf"the minimum is at least {NUMBER}; .* is below {NUMBER}\.", said
        ):
            self.add(f"checker: {match[0]}", Decimal(match[1]), oracle.minimum, lower=True)
            self.add(f"checker: {match[0]}", Decimal(match[2]), root(gap / ball(oracle.mass)))
        for match in re.finditer(rf"weights: {NUMBER}; .* translation: {NUMBER}; both", said):
            self.add(f"checker: {match[0]}", Decimal(match[1]), ball(oracle.mass))
            self.add(f"checker: {match[0]}", Decimal(match[2]), ball(oracle.objective(r)))

    def assessment(self, found: Assessment, q: Sequence[float], t: Sequence[float]) -> None:
        """What `assess` says of any pose."""
        gap, document = self.oracle.gap(doubles(q), doubles(t)), assessment_document(found)
        document = {key: value for key, value in document.items() if isinstance(value, float)}
        self.add("assess gap_lower", document.get("gap_lower"), gap, lower=True)
        self.add("assess gap_upper", document.get("gap_upper"), gap)
        text = assessment_summary(found)
        for match in re.finditer(rf"between {NUMBER} and {NUMBER} \(proved\)", text):
            self.add(f"assess: {match[0]}", Decimal(match[1]), gap, lower=True)
            self.add(f"assess: {match[0]}", Decimal(match[2]), gap)
        for match in re.finditer(rf"at most {NUMBER} (?:\(proved\)|\()", text):
            self.add(f"assess: {match[0]}", Decimal(match[1]), gap)
        for words, kind, number in read(
            [(rf"within {NUMBER} degrees", ANGLE), (rf"\({NUMBER} of the range\)", SHARE)], text
        ):
            self.add(f"assess: {words}", *self.told(kind, number, doubles(q), doubles(t)))


def doubles(values: Sequence[float]) -> list[Fraction]:
    return [Fraction(value) for value in values]


def dyadic(pair: list[int] | None) -> Fraction | None:
    return None if pair is None else Fraction(pair[0]) * Fraction(2) ** pair[1]


# Problems ----------------------------------------------------------------------------------------


def generic(rng: np.random.Generator) -> tuple[Any, Any, Any]:
    n = int(rng.integers(3, 16))
    x = rng.normal(size=(n, 3))
    noise = 10.0 ** rng.uniform(-16, 0.5)
    return x, x @ random_rotation(rng).T + noise * rng.normal(size=(n, 3)), np.ones(n)


def weighted(rng: np.random.Generator) -> tuple[Any, Any, Any]:
    x, y, w = generic(rng)
    return x, y, w * 10.0 ** rng.uniform(-15, 15, size=len(w))


def planar(rng: np.random.Generator) -> tuple[Any, Any, Any]:
    x, y, w = generic(rng)
    x[:, 2] = 0.0
    return x, y, w


def nearly_mirrored(rng: np.random.Generator) -> tuple[Any, Any, Any]:
    """The two best rotations are almost equally good."""
    x, _, w = generic(rng)
    x[:, 1] = x[:, 2] + 10.0 ** rng.uniform(-12, -1) * rng.normal(size=len(w))
    y = x * np.array([1.0, 1.0, -1.0]) @ random_rotation(rng).T
    return x, y + 10.0 ** rng.uniform(-14, -1) * rng.normal(size=y.shape), w


def symmetric(rng: np.random.Generator) -> tuple[Any, Any, Any]:
    specimen = ZOO[int(rng.integers(len(ZOO)))]
    x, y = np.array(specimen.source), np.array(specimen.target)
    return x, y, np.full(len(x), 2.0 ** int(rng.integers(-20, 20)))


def integral(rng: np.random.Generator) -> tuple[Any, Any, Any]:
    n = int(rng.integers(2, 7))
    x, y = rng.integers(-2, 3, size=(2, n, 3)).astype(float)
    return x, y, rng.integers(1, 4, size=n).astype(float)


FAMILIES: tuple[Callable[[np.random.Generator], tuple[Any, Any, Any]], ...] = (
    generic,
    weighted,
    planar,
    nearly_mirrored,
    symmetric,
    integral,
)


def made(seed: int) -> RegistrationProblem:
    """A problem of one of the families, moved away and scaled by powers of ten in a third each."""
    rng = np.random.default_rng([16, seed])
    x, y, w = FAMILIES[seed % len(FAMILIES)](rng)
    if seed % 3 == 1:
        x, y = x + 10.0 ** rng.uniform(0, 16), y - 10.0 ** rng.uniform(0, 16)
    if seed % 3 == 2:
        x, y = x * 10.0 ** rng.uniform(-60, 60), y * 10.0 ** rng.uniform(-60, 60)
    return RegistrationProblem(x, y, weights=w)


def other_pose(registration: Registration, seed: int) -> tuple[list[float], list[float]]:
    """The pose found, turned and moved by little or much."""
    rng = np.random.default_rng([17, seed])
    q = registration.pose.quaternion_wxyz + 10.0 ** rng.uniform(-16, 1) * rng.normal(size=4)
    t = registration.pose.translation
    t = t + 10.0 ** rng.uniform(-16, 1) * rng.normal(size=3) * (np.abs(t).max() + 1e-300)
    return (q / np.linalg.norm(q)).tolist(), t.tolist()


def bounds_of(problem: RegistrationProblem, seed: int = 0) -> list[Bound]:
    """All bounds that are printed of a problem."""
    registration = certify(problem, simulation=False)
    q, t = other_pose(registration, seed)
    assessment = assess(problem, np.array(q), np.array(t))
    with flint.ctx.workprec(BITS):
        reader = Reader(Oracle.of(problem))
        reader.registration(registration)
        reader.assessment(assessment, q, t)
    return reader.bounds


def main() -> None:
    amount, first = ([int(word) for word in sys.argv[1:]] + [PROBLEMS, 0][len(sys.argv) - 1 :])[:2]
    begun, places, refused, wrong = time.perf_counter(), Counter[str](), 0, 0
    for done, seed in enumerate(range(first, first + amount)):
        if done % 500 == 0:
            print(f"{done} of {amount} problems, {wrong} wrong", file=sys.stderr)
        try:
            bounds = bounds_of(made(seed), seed)
        except OutOfRangeError:
            refused += 1
            continue
        places.update(bound.kind for bound in bounds)
        for bound in bounds:
            if not bound.holds():
                wrong += 1
                print(f"problem {seed}: {bound.place} is no bound of {bound.true.str(9)}")
    for place, count in sorted(places.items()):
        print(f"{count:8} {place}")
    total = f"{sum(places.values())} bounds of {amount - refused} problems ({refused} refused)"
    print(f"{total} in {time.perf_counter() - begun:.0f} s: {wrong} do not hold")
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
