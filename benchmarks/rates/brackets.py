"""Every printed bound beside an exact oracle, on 5,000 random problems.

A bound is read where a user reads it: in the JSON, in the text of the terminal, on the page, in the
checker's sentences, in the certificate. The oracle works in ball arithmetic of 3,000 bits.
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
from typing import TYPE_CHECKING, Any

import flint
import numpy as np
from commands import checked
from oracles.kabsch import Oracle, ball, root
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
