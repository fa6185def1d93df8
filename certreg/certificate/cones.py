"""Producing a certificate of kind "springs-cones", where no sum of squares proves enough.

f is the objective of a rotation, F(q)/|q|^4 in quaternions, W at least max f - min f. The body
states a growth form: with u the certified pose, an angle a away from the rotation S,

    f(S) > f(u) - delta + mu sin^2(a/2).                                                    (+)

Caps. The Hessian of f in rotation angle changes by at most 4 W an angle of 1 (Bernstein, twice). So
within r = k/(8 W) of a rotation c where it exceeds k it exceeds k/2, and f is at least
f(c) - g a + k a^2/4, g the slope at c: (+) holds there if c = u and g^2 < (k - mu) delta, or if
f(c) - g^2/k > f(u) - delta + mu.

Cones. Outside of the caps F - (f(u) - delta) |q|^4 - mu |q|^2 (|q|^2 - (u.q)^2) is to be positive.
It is on a cone of four quaternions if its 35 Bernstein coefficients are. If they are not, the cone
is cut in two, unless it lies in a cap. This ends, but where the form has a zero outside of the
caps: for every delta other than f(u) - min f itself.

The file holds pose, caps, delta and mu; the checker cuts by itself. What is proposed here rests on
the same integers, and on doubles for caps and vertices.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, TypeVar

import numpy as np

from certreg.certificate.envelope import Certificate, enclosed
from certreg.certificate.radius import growth_radius
from certreg.certificate.squares import (
    SpringsBody,
    SpringsSosBody,
    growth_claims,
    require_near,
    sos_body,
)
from certreg.equilibrium.quartics import FloatingQuartic, descended
from certreg.errors import NotCompiledWarning
from certreg.exact.dyadic import Dyadic, dyadic_above, dyadic_below
from certreg.exact.elimination import is_positive_definite
from certreg.geometry.so3 import body_frame, dot, squared_norm
from certreg.native.cones import ConesEnding, search_cones
from certreg.native.kernels import MissingLibraryError
from certreg.objective.normalisation import levelled_exactly
from certreg.objective.quartics import MONOMIALS, PLACE
from certreg.relaxation.refining import refined
from certreg.results import Brief
from certreg.verify import CAPS_MAX

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.exact.spaces import IntegerQuaternion
    from certreg.objective.springs import Springs
    from certreg.problem.problem import RegistrationProblem
    from certreg.relaxation.optimum import Found


BUDGET = 300_000  # cones; the checker refuses beyond
CAPS = 16  # the checker takes a few more
NUMBER_BITS = 32  # mantissas of mu, delta and curvatures
NEAR = 2.0**-30  # of W: a minimum that is so little above the best one needs a cap of its own
LEAST_CURVATURE = 2.0**-26  # of W: caps of weaker minima are too small for cones of 192 cuts
LEAST_GROWTH = 2.0**-90  # of W: below, 124 bits do not tell the form from 0 away from the caps
SLACK = 2.0**-160  # of W: a delta where the slope is 0
FINE, COARSE = 2.0**-44, 2.0**-25  # of W, at most eight times the range: 1e-12, 1e-6 of that
RETREATS = 12  # smaller mu, after a rotation where the growth is less
RESTARTS = 12  # from better rotations: there are eight local minima at most, but for continua
VERTEX_BITS = 60  # of a vertex, which has fewer
FINE_WORDS = "Cones prove the gap down to 1e-12 of the range of the energy."
COARSE_WORDS = (
    f"Cones prove the gap down to 1e-6 of the range only: {BUDGET} did not suffice for 1e-12."
)
UNIQUE_WORDS = "Cones prove the growth of the energy away from the optimum."
TIED_WORDS = "Cones prove that nothing is below the best minima, which are too close to be ranked."
CONSTANT_WORDS = "The energy is the same at every rotation."
NOTHING_WORDS = f"{BUDGET} cones did not suffice to bound the gap by 1e-6 of the range."

RANGES: dict[tuple[int, ...], Fraction] = {  # of monomials on the unit quaternions, by powers
    (4, 0, 0, 0): Fraction(1),
    (2, 2, 0, 0): Fraction(1, 4),
    (3, 1, 0, 0): Fraction(3, 4),
    (2, 1, 1, 0): Fraction(1, 4),
    (1, 1, 1, 1): Fraction(1, 8),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringsConesBody(SpringsBody):
    """A proof that a pose of general springs is optimal up to bounds, by cones and caps.

    delta, mu: the objective exceeds its value here less delta by mu sin^2(theta/2), theta the angle
        to that rotation; in units of the energy. delta is the claimed gap.
    caps: of each six integers: a quaternion, at whose rotation the Hessian of the objective, in
        rotation angle, exceeds curvature I; mantissa and exponent of the curvature.
    """

    KIND: ClassVar[str] = "springs-cones"
    PLACES: ClassVar = {**SpringsBody.PLACES, "mu": "proof.mu", "caps": "proof.caps"}

    mu: Dyadic
    caps: Annotated[tuple[int, ...], range(0, 6 * CAPS_MAX + 1, 6)]

    @property
    def delta(self) -> Dyadic:
        """The objective exceeds its value here less this by mu sin^2(theta/2)."""
        return self.claims.gap

    @property
    def growth(self) -> Fraction:
        """The objective exceeds its value here less `gap` by this times sin^2(theta/2)."""
        return self.mu.value


AnyBody = TypeVar("AnyBody", "SpringsSosBody", SpringsConesBody)


@dataclass(frozen=True, slots=True, kw_only=True)
class ConesProposal(Brief):
    """What cones are proposed to prove.

    body: None where nothing is. better: then the quaternion of a better rotation, if one was met.
    seen: cones looked at.
    """

    seen: int
    body: SpringsConesBody | None = None
    words: str = NOTHING_WORDS
    better: IntegerQuaternion | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class CappedMinimum:
    """A local minimum, nearly; values are those of F(q)/|q|^4.

    slope: square of the gradient in rotation angle. curvature: less than the least eigenvalue of
    the Hessian, proved; None where that is not positive, or too small for a cap.
    """

    quaternion: IntegerQuaternion
    value: Fraction
    slope: Fraction
    curvature: Fraction | None

    @property
    def floor(self) -> Fraction:
        """A lower bound of f in the cap."""
        return self.value - (self.slope / self.curvature if self.curvature else 0)


@dataclass(frozen=True, slots=True, kw_only=True)
class ConesAttempt:
    """A growth form to be proved with these caps; mu and delta in the units of F."""

    mu: Fraction
    delta: Fraction
    capped: tuple[CappedMinimum, ...]
    words: str
    tied: bool = False


def springs_certificate(
    problem: RegistrationProblem,
    objective: Springs,
    found: Found,
    *,
    robustness_angle: float | None = None,
    about: dict[str, Any] | None = None,
) -> Certificate[SpringsSosBody] | Certificate[SpringsConesBody] | None:
    """A certificate of the optimum that was found, by squares or by cones; None if not proved.

    Cones are cut where squares leave open whether the optimum is unique, and kept where they prove
    more; `about` says then how. robustness_angle: as `produce` takes it.
    None means not proved, not disproved. Raises InvalidProblemError for sizes too far apart.
    """
    require_near(problem)
    squares = sos_body(objective, found)
    if squares is not None and squares.claims.unique is not None:
        return enclosed(problem, _moving(objective, squares, robustness_angle), about)
    cones = _cones(objective, found)
    body = cones.body
    if body is not None and (squares is None or body.claims.unique or body.gap < squares.gap):
        told = {**(about or {}), "cones": cones.words}
        return enclosed(problem, _moving(objective, body, robustness_angle), told)
    if squares is None:
        return None
    return enclosed(problem, _moving(objective, squares, robustness_angle), about)


def _cones(objective: Springs, found: Found) -> ConesProposal:
    """What cones prove; without compiled code nothing, and a warning says so."""
    try:
        return cones_body(objective, found.minima)
    except MissingLibraryError as error:
        warnings.warn(str(error), NotCompiledWarning, stacklevel=2)
        return ConesProposal(body=None, words=str(error), seen=0)


def _moving(objective: Springs, body: AnyBody, degrees: float | None) -> AnyBody:
    """The same body, with how far the points may move where that is proved and asked for."""
    if degrees is None:
        return body
    radius = growth_radius(
        objective.moments,
        mu=body.growth,
        delta=body.gap,
        value=objective.energy(body.quaternion),
        degrees=degrees,
    )
    return replace(body, radius=radius)


def cones_body(objective: Springs, minima: Sequence[IntegerQuaternion]) -> ConesProposal:
    """A body that proves the best of some local minima optimal, or a better rotation that is met.

    minima: integers, as `relaxation` refines them, in any order.
    """
    known, proposal = list(minima), ConesProposal(seen=0)
    for _ in range(RESTARTS):
        found = ConeProof.of(objective, known).run()
        proposal = replace(found, seen=proposal.seen + found.seen)
        if found.better is None:
            break
        known.append(_descended_from(objective, found.better))
    return proposal


def _descended_from(objective: Springs, start: IntegerQuaternion) -> IntegerQuaternion:
    levelled = levelled_exactly(objective.quartic)
    length = float(squared_norm(start)) ** 0.5
    unit = np.array([[entry / length for entry in start]])
    return refined(levelled, descended(FloatingQuartic.of(levelled.rest), unit).points[0].tolist())


@dataclass(frozen=True, slots=True, kw_only=True)
class ConeProof:
    """The best of some minima, and what is tried to prove of it. width: W, in the units of F."""

    objective: Springs
    width: Fraction
    own: CappedMinimum
    others: tuple[CappedMinimum, ...]

    @classmethod
    def of(cls, objective: Springs, quaternions: Sequence[IntegerQuaternion]) -> ConeProof:
        """The best of these is to be proved."""
        width = _width(objective.quartic)
        known = sorted(
            (_minimum(objective, width, q) for q in quaternions), key=lambda found: found.value
        )
        own, *others = known
        return cls(objective=objective, width=width, own=own, others=tuple(others))

    def run(self) -> ConesProposal:
        """What is proved, or a better rotation."""
        proposal = ConesProposal(seen=0)
        for attempt in self.attempts():
            found = self._tried(attempt)
            proposal = replace(found, seen=proposal.seen + found.seen)
            if found.body is not None or found.better is not None:
                break
        return proposal

    def _tried(self, attempt: ConesAttempt) -> ConesProposal:
        """One attempt, with smaller mu where the growth turns out to be less."""
        seen, caps = 0, self._caps(attempt)
        for _ in range(RETREATS):
            body = self.body(attempt)
            search = search_cones(self._form(body), caps, budget=BUDGET)
            seen += search.seen
            if search.ending is ConesEnding.POSITIVE:
                return ConesProposal(body=body, words=attempt.words, seen=seen)
            if search.vertex is None:
                break
            vertex = _integers(search.vertex)
            if self._value(vertex) < self.own.value - attempt.delta:
                return ConesProposal(seen=seen, better=vertex)
            mu = min(self._growth_at(vertex), attempt.mu) / 2
            if mu < LEAST_GROWTH * self.width:
                break
            attempt = replace(attempt, mu=mu)
        return ConesProposal(seen=seen)

    def attempts(self) -> Iterator[ConesAttempt]:
        """What may be proved, the strongest first."""
        own, W = self.own, self.width
        slack = Fraction(SLACK) * (W or abs(own.value) or 1)
        if not W:
            yield ConesAttempt(mu=Fraction(0), delta=slack, capped=(), words=CONSTANT_WORDS)
            return
        near = [m for m in self.others if m.value - own.value <= Fraction(NEAR) * W][:CAPS]
        whole = own.curvature is not None and all(m.curvature is not None for m in near)
        if whole and own.curvature is not None:
            mu = min([own.curvature / 2, *[self._rise(m, near) for m in self.others]])
            if mu > slack:
                delta = max(2 * own.slope / (own.curvature - mu), slack)
                yield ConesAttempt(mu=mu, delta=delta, capped=(own, *near), words=UNIQUE_WORDS)
            if near:
                delta = max(slack, *[2 * (own.value - m.floor) for m in (own, *near)])
                tied = own.slope == 0 and any(m.value == own.value for m in near)
                yield ConesAttempt(
                    mu=Fraction(0), delta=delta, capped=(own, *near), words=TIED_WORDS, tied=tied
                )
        for share, words in ((FINE, FINE_WORDS), (COARSE, COARSE_WORDS)):
            delta = Fraction(share) * W
            held = [m for m in (own, *near) if m.curvature and own.value - m.floor < delta / 2]
            yield ConesAttempt(mu=Fraction(0), delta=delta, capped=tuple(held), words=words)

    def _rise(self, other: CappedMinimum, near: Sequence[CappedMinimum]) -> Fraction:
        """A growth that leaves half the room at another minimum, or at the bound in its cap."""
        if other in near:
            return (other.floor - self.own.value) / 2
        return self._growth_at(other.quaternion) / 2

    def _growth_at(self, q: IntegerQuaternion) -> Fraction:
        """How much the objective grows, over sin^2 of half the angle to the pose."""
        u = self.own.quaternion
        norms = squared_norm(u) * squared_norm(q)
        across = norms - dot(u, q) ** 2
        return (self._value(q) - self.own.value) * norms / across if across else Fraction(0)

    def _value(self, q: IntegerQuaternion) -> Fraction:
        return Fraction(self.objective.value(q), squared_norm(q) ** 2)

    def body(self, attempt: ConesAttempt) -> SpringsConesBody:
        """With all claims that follow, by the rules of the checker."""
        unit = self.objective.unit
        gap = dyadic_above(attempt.delta * unit, NUMBER_BITS)
        mu = dyadic_below(attempt.mu * unit, NUMBER_BITS)
        found = growth_claims(self.objective, gap.value, mu.value, self.width * unit)
        claims, symmetry = replace(found[0], gap=gap), found[1]
        if attempt.tied:
            claims, symmetry = replace(claims, unique=False), None
        return SpringsConesBody(
            quaternion=self.own.quaternion,
            mu=mu,
            caps=tuple(
                k
                for m in attempt.capped
                for pair in [dyadic_below((m.curvature or 0) * unit, NUMBER_BITS).pair]
                for k in (*m.quaternion, *pair)
            ),
            claims=claims,
            symmetry=symmetry,
            rotation_only=self.objective.motion.arguments["rotation_only"],
        )

    def _form(self, body: SpringsConesBody) -> list[int]:
        """What is to be positive, times a positive number."""
        tied = body.claims.unique is False and body.symmetry is None
        delta = 0 if tied else body.delta.value
        mu, unit, u = body.mu.value, self.objective.unit, self.own.quaternion
        level = self.own.value - delta / unit
        growth = mu / unit / squared_norm(u)
        over = level.denominator * growth.denominator
        form = [entry * over for entry in self.objective.quartic]
        base, along = int((level + growth * squared_norm(u)) * over), int(growth * over)
        for i, j, k in product(range(4), repeat=3):
            place = PLACE[tuple(sorted((i, j, k, k)))]
            form[place] += along * u[i] * u[j] - base * (i == j)
        return form

    def _caps(self, attempt: ConesAttempt) -> NDArray[np.float64]:
        """(k, 5), as `search_cones` takes them: the radius is curvature/(8 W), halved twice."""
        rows: list[list[float]] = []
        for m in attempt.capped:
            length = float(squared_norm(m.quaternion)) ** 0.5
            quarter = float((m.curvature or 0) / (16 * self.width))
            rows.append(
                [*[entry / length for entry in m.quaternion], quarter**2 * (1 - quarter**2 / 3)]
            )
        return np.array(rows).reshape(-1, 5)


def _minimum(objective: Springs, width: Fraction, q: IntegerQuaternion) -> CappedMinimum:
    norm = squared_norm(q)
    frame = list(zip(*body_frame(q), strict=True))
    gradient, second = objective.gradient(q), objective.hessian(q)
    value = objective.value(q)
    slope = Fraction(sum(dot(e, gradient) ** 2 for e in frame), 4 * norm**4)
    bend = [
        [dot(a, [dot(row, b) for row in second]) - 4 * value * (a is b) for b in frame]
        for a in frame
    ]
    return CappedMinimum(
        quaternion=q,
        value=Fraction(value, norm**2),
        slope=slope,
        curvature=_curvature(bend, 4 * norm**2, width),
    )


def _curvature(bend: Sequence[Sequence[int]], over: int, width: Fraction) -> Fraction | None:
    """A little less than the least eigenvalue of bend/over, proved; None below LEAST_CURVATURE."""
    scale = width * over
    if not scale:
        return None
    doubles = np.array([[float(entry / scale) for entry in row] for row in bend])
    least = float(np.linalg.eigvalsh(doubles)[0]) * (1 - 2.0**-10)
    if not least > LEAST_CURVATURE:
        return None
    p, q = (Fraction(least) * scale).as_integer_ratio()
    rows = [[q * entry - p * (i == j) for j, entry in enumerate(row)] for i, row in enumerate(bend)]
    return Fraction(least) * width if is_positive_definite(rows) else None


def _width(quartic: Sequence[int]) -> Fraction:
    """At least max F - min F over unit quaternions, by the sizes of monomials there.

    The constant mean * |q|^4 is taken off; q_i^4 is from 0 to 1, q_i^2 q_j^2 from 0 to 1/4, and the
    sizes of q_i^3 q_j, q_i^2 q_j q_k, wxyz are at most 3/8, 1/8, 1/16.
    """
    levelled = levelled_exactly(quartic)
    total = Fraction(0)
    for monomial, entry in zip(MONOMIALS, levelled.integers, strict=True):
        powers = sorted((monomial.count(k) for k in range(4)), reverse=True)
        total += abs(entry) * RANGES[tuple(powers)]
    return total / 24


def _integers(vertex: Sequence[float]) -> IntegerQuaternion:
    """The same line: vertices of cones are dyadic, of few bits."""
    w, x, y, z = (int(entry * 2.0**VERTEX_BITS) for entry in vertex)
    return (w, x, y, z)
