"""The claims of the paper, each with its finding, its proof, and what was measured of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from certreg.paper.claims import MEASURED
from certreg.paper.counterexamples import CertifiedCloud, certified_clouds, in_doubles
from certreg.paper.derivation import paper_claims, proving
from certreg.paper.observations import observe

if TYPE_CHECKING:
    from collections.abc import Mapping
    from concurrent.futures import Future

    from certreg.paper.claims import Evidence
    from certreg.paper.observations import Observations, Setup, StageProgress
    from certreg.results import Verdict


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
