"""The counterexamples as registration problems whose optimum and equilibria are certified.

The points are those of the counterexample exactly, in a unit of length in which all coordinates are
integers: a change of unit turns no pose and moves no equilibrium, and accelerations of the rotation
stay what they are. What a certificate says is the checker's word, as for any other user.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from certreg.certificate.checking import verify
from certreg.certificate.count import AT_MOST, count_certificate
from certreg.certificate.isotropic import produce
from certreg.errors import InvalidProblemError
from certreg.geometry.so3 import squared_norm
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.problem.random_instances import PAPER_DAMPING
from certreg.results import Ruling, Verdict

if TYPE_CHECKING:
    from collections.abc import Sequence


SUFFIX, COUNT_SUFFIX = ".json", ".count.json"
NO_PROOF = Verdict(ruling=Ruling.INCONCLUSIVE, words="no certificate was found")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CertifiedCloud:
    """One cloud of a counterexample, certified.

    files: contents of the certificates by file name, first that of the optimum and the pattern,
    then that of at most four equilibria, where there are not more. words: what they prove that
    matters. verdict: the checker's on all of them.
    """

    problem: RegistrationProblem
    files: dict[str, bytes]
    words: str
    verdict: Verdict


def certified_clouds(row: Any) -> tuple[CertifiedCloud, ...]:
    """The clouds of the counterexample to a claim (audit.Row), certified; none if it is true.

    Raises InvalidProblemError where a coordinate is no double in any unit of length.
    """
    if row.counterexample is None:
        return ()
    clouds = row.counterexample.clouds
    about = {"counterexample": row.counterexample.words, "claim": row.claim}
    names = [row.number + f"-{k}" * (len(clouds) > 1) for k in range(1, len(clouds) + 1)]
    return tuple(_certified_cloud(n, c, about) for n, c in zip(names, clouds, strict=True))


def in_doubles(cloud: Any) -> RegistrationProblem:
    """A cloud of a counterexample (rationals.ExactCloud) in doubles: small integers, so exactly."""
    source = [[float(e) for e in point] for point in cloud.source]
    target = [[float(e) for e in point] for point in cloud.target]
    weights = [float(mass) for mass in cloud.weights]
    return RegistrationProblem(source, target, weights=weights, damping=PAPER_DAMPING)


def in_integers(cloud: Any) -> RegistrationProblem:
    """A cloud of a counterexample (rationals.ExactCloud) in the unit that clears denominators.

    Raises InvalidProblemError where an integer is too large for a double.
    """
    points = [*cloud.source, *cloud.target]
    unit = math.lcm(*(Fraction(e).denominator for point in points for e in point))
    share = math.lcm(*(Fraction(mass).denominator for mass in cloud.weights))
    return RegistrationProblem(
        [[_double(e * unit) for e in point] for point in cloud.source],
        [[_double(e * unit) for e in point] for point in cloud.target],
        weights=[_double(mass * share) for mass in cloud.weights],
    )


def _double(number: Any) -> float:
    if float(number) != number:
        raise InvalidProblemError(
            f"{number} is no double: give points of smaller denominators", value=number
        )
    return float(number)


def _certified_cloud(name: str, cloud: Any, about: dict[str, Any]) -> CertifiedCloud:
    problem = in_integers(cloud)
    objective = Isotropic(exact_moments(problem))
    made = (produce(problem, objective, about=about), count_certificate(problem))
    suffixes = (SUFFIX, COUNT_SUFFIX)
    files = {
        name + suffix: certificate.to_json()
        for suffix, certificate in zip(suffixes, made, strict=True)
        if certificate is not None
    }
    return CertifiedCloud(
        problem=problem,
        files=files,
        words=_words(objective, counted=made[1] is not None),
        verdict=_judged(list(files.values()), problem) if made[0] else NO_PROOF,
    )


def _judged(contents: Sequence[bytes], problem: RegistrationProblem) -> Verdict:
    """The checker's verdict on the first file that is refused, or on the first of all."""
    verdicts = [verify(content, problem) for content in contents]
    return next((v for v in verdicts if not v.proved), verdicts[0])


def _words(objective: Isotropic, *, counted: bool) -> str:
    """Uniqueness, spurious equilibria, and how far the optimum is from the paper's start."""
    shape = objective.classification
    spurious = "infinitely many" if shape.spurious is None else shape.spurious
    w, *axis = objective.optimum
    turn = math.degrees(2.0 * math.atan2(math.sqrt(squared_norm(axis)), abs(w)))
    parts = [
        f"pattern {', '.join(map(str, shape.pattern))}",
        f"{spurious} spurious",
        f"one optimum, {turn:.7g}° from R = I" if shape.unique else "the optimum is not unique",
    ]
    return "; ".join(parts + [f"at most {AT_MOST} equilibria"] * counted)
