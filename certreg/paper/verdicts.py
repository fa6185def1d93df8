"""The claims of the paper, each with its finding, its proof, and what was measured of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from certreg.paper import derivation, motions, statics
from certreg.paper.evidence import Clouds, Evidence, in_doubles
from certreg.paper.exhibits import Exhibit, exhibits
from certreg.paper.observations import observe
from certreg.paper.proofs import proving

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from concurrent.futures import Future

    from certreg.paper.observations import Announcer, Observations, Setup
    from certreg.results import Verdict

MEASURED: dict[str, Callable[[Observations, Clouds], Evidence]] = {
    "1": statics.objective,
    "2": statics.equations,
    "3": statics.energy_rate,
    "4a": statics.unbounded,
    "4b": motions.converging,
    "5": statics.balance,
    "6a": statics.unique_optimum,
    "6b": statics.optimum_at_rest,
    "6c": statics.no_contradiction,
    "7": statics.three_spurious,
    "8a": statics.four_equilibria,
    "8b": statics.half_turns,
    "9a": statics.symmetric_clouds,
    "9b": statics.polygons,
    "9c": statics.infinite_without_symmetry,
    "10": statics.spurious_unstable,
    "11": statics.pattern,
    "12": statics.six_zeros,
    "13a": motions.falling_energy,
    "13b": motions.rising_energy,
    "14": statics.definite_inertia,
    "15a": motions.always_optimal,
    "15b": motions.any_damping,
    "15c": motions.stopping_rule,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class ClaimVerdict:
    """One claim (audit.Row): whether its finding is proved, and whether the measurements agree.

    proof: on the finding, the book's claims proved and the counterexample recomputed in fractions;
    None where the proofs were left out. exhibits: the clouds of the counterexample, certified.
    """

    row: Any
    proof: Verdict | None
    evidence: Evidence
    exhibits: tuple[Exhibit, ...]

    @property
    def stands(self) -> bool:
        """Whether nothing that was asked contradicts the finding, and all exhibits are proved."""
        certified = all(each.verdict.proved for each in self.exhibits)
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


def reproduce(setup: Setup, progress: Announcer, *, proofs: bool = True) -> Reproduction:
    """Every experiment of the paper, and every claim with its verdict.

    proofs: whether the claims of the book that the findings rest on are proved anew, in processes
    of their own meanwhile. Raises InvalidProblemError and DegenerateProblemError for a setup whose
    instances cannot be made or simulated.
    """
    rows = derivation.paper_claims()
    if not proofs:
        seen = observe(setup, progress)
        return Reproduction(observations=seen, claims=tuple(_claim(r, None, seen) for r in rows))
    names = list(dict.fromkeys(name for row in rows for name in row.because))
    with proving(names) as coming:
        seen = observe(setup, progress)
        book = dict(_waited(coming, progress))
    claims = tuple(_claim(row, row.stands(book), seen) for row in rows)
    return Reproduction(observations=seen, claims=claims)


def _claim(row: Any, proof: Verdict | None, seen: Observations) -> ClaimVerdict:
    counterexample = row.counterexample
    clouds = () if counterexample is None else counterexample.clouds
    doubles = [in_doubles(cloud) for cloud in clouds]
    evidence = MEASURED[row.number](seen, doubles)
    return ClaimVerdict(row=row, proof=proof, evidence=evidence, exhibits=exhibits(row))


def _waited(
    coming: Mapping[str, Future[Verdict]], progress: Announcer
) -> list[tuple[str, Verdict]]:
    found: list[tuple[str, Verdict]] = []
    for done, (name, future) in enumerate(coming.items()):
        progress("proofs", done, len(coming))
        found.append((name, future.result()))
    progress("proofs", len(coming), len(coming))
    return found
