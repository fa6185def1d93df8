"""The claims of the paper, each with its finding, its proof, and what was measured of it.

The counterexamples are registration problems whose optimum and equilibria are certified. Their
points are exactly those of the audit, in a unit of length in which all coordinates are integers: a
change of unit turns no pose and moves no equilibrium, and accelerations of the rotation stay what
they are. What a certificate says is the checker's word, as for any other user.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from certreg.certificate.checking import verify
from certreg.certificate.count import AT_MOST, count_certificate
from certreg.certificate.isotropic import produce
from certreg.errors import InvalidProblemError
from certreg.geometry.so3 import squared_norm
from certreg.objective.isotropic import Isotropic
from certreg.paper.claims import MEASURED, Evidence
from certreg.paper.derivation import paper_claims, proving
from certreg.paper.observations import Observations, Setup, StageProgress, observe
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.problem.random_instances import PAPER_DAMPING
from certreg.results import Ruling, Verdict

if TYPE_CHECKING:
    from concurrent.futures import Future


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


@dataclass(frozen=True, slots=True, kw_only=True)
class ClaimVerdict:
    """One claim (audit.Row): whether its finding is proved, and whether the measurements agree.

    proof: on the finding, the book's claims proved and the counterexample recomputed in fractions;
    None where the proofs were left out. certified: the clouds of the counterexample, certified.
    """

    row: Any
    proof: Verdict | None
    evidence: Evidence
    certified: tuple[CertifiedCloud, ...]

    @property
    def stands(self) -> bool:
        """Whether nothing asked contradicts the finding, and all certificates are proved."""
        certified = all(each.verdict.proved for each in self.certified)
        return certified and self.evidence.agrees and (self.proof is None or self.proof.proved)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reproduction:
    """What was observed, and the verdicts on all claims."""

    observations: Observations
    claims: tuple[ClaimVerdict, ...]

    @property
    def stands(self) -> bool:
        """Whether every finding does."""
        return all(claim.stands for claim in self.claims)


def reproduce(setup: Setup, progress: StageProgress, *, proofs: bool = True) -> Reproduction:
    """Every experiment of the paper, and every claim with its verdict.

    proofs: whether the claims of the book that the findings rest on are proved anew, in processes
    of their own meanwhile. Raises InvalidProblemError and DegenerateProblemError for a setup whose
    instances cannot be made or simulated.
    """
    rows = paper_claims()
    if not proofs:
        observed = observe(setup, progress)
        return Reproduction(
            observations=observed, claims=tuple(_claim(r, None, observed) for r in rows)
        )
    names = list(dict.fromkeys(name for row in rows for name in row.because))
    with proving(names) as coming:
        observed = observe(setup, progress)
        book = dict(_waited(coming, progress))
    claims = tuple(_claim(row, row.stands(book), observed) for row in rows)
    return Reproduction(observations=observed, claims=claims)


def _claim(row: Any, proof: Verdict | None, observed: Observations) -> ClaimVerdict:
    counterexample = row.counterexample
    clouds = () if counterexample is None else counterexample.clouds
    doubles = [in_doubles(cloud) for cloud in clouds]
    evidence = MEASURED[row.number](observed, doubles)
    return ClaimVerdict(row=row, proof=proof, evidence=evidence, certified=certified_clouds(row))


def _waited(
    coming: Mapping[str, Future[Verdict]], progress: StageProgress
) -> list[tuple[str, Verdict]]:
    verdicts: list[tuple[str, Verdict]] = []
    for done, (name, future) in enumerate(coming.items()):
        progress("proofs", done, len(coming))
        verdicts.append((name, future.result()))
    progress("proofs", len(coming), len(coming))
    return verdicts
