"""The least squares over all pairs, or over some of them: their provers, by structure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

from certreg._loading import found_late
from certreg.certificate.checking import check_own, require_accepted
from certreg.exact.dyadic import nearest_double, nearest_root
from certreg.objective.structure import Structure
from certreg.registration.optimum import exact_pose
from certreg.registration.pipeline import USUAL, Asked, Prover, Work, accepting
from certreg.registration.result import Registration, Solution
from certreg.results import OUT_OF_RANGE, Absent, Verdict

if TYPE_CHECKING:
    from certreg.certificate.envelope import Certificate
    from certreg.problem.problem import RegistrationProblem
    from certreg.problem.support import Cell
    from certreg.registration.pipeline import Provers
    from certreg.registration.row_names import RowNames


Proposal = TypeVar("Proposal")
Solved = TypeVar("Solved", bound=Solution)

SQUARES: Mapping[Structure, Provers] = {
    Structure.LINEAR: (
        found_late("certreg.registration.linear", "RIGID"),
        found_late("certreg.registration.linear", "SIMILARITY"),
    ),
    Structure.QUARTIC: (found_late("certreg.registration.quartic", "PROVER"),),
}
NOT_CERTIFIED = Absent("not certified")
BY_NAME = Absent(
    "with --max-residual it is taken only where it is named, of the pairs within: --solver NAME "
    "(relaxation), --integrator NAME (simulation)"
)


class SquaresProver(Prover[Proposal, Solved, "Registration[Solved]"]):
    """Of least squares over all pairs; structures differ in proposal and proof alone."""

    def check(self, proved: Solved, work: Work) -> Verdict | None:
        """The checker's answer; None where there is no certificate. Raises where it refuses."""
        verdict, certificate = None, proved.certificate
        if certificate is not None:
            verdict = check_own(certificate, proved.problem)
            work.lap("check")
            require_accepted(verdict)
            self.require_sound(proved, certificate)
        work.done("checker")
        return verdict

    def require_sound(self, proved: Solved, certificate: Certificate[Any]) -> None:
        """Nothing, unless something that was computed contradicts the certificate."""

    def judge(
        self, proved: Solved, verdict: Verdict | None, asked: Asked, timings: dict[str, float]
    ) -> Registration[Solved]:
        """What a solution says of the pose as it is printed."""
        if proved.problem.mapped:
            proved.complete()
        certificate = proved.certificate
        worth = proved.worth(exact_pose(proved.pose), certificate and certificate.body)
        return Registration(
            problem=proved.problem,
            solution=proved,
            objective=nearest_double(worth.energy),
            rmse=None if worth.mean_square is None else nearest_root(worth.mean_square),
            bounds=worth.bounds,
            limits=asked.limits,
            verdict=verdict,
            timings=timings,
            absent={
                **proved.absent,
                "objective": OUT_OF_RANGE,
                "rmse": OUT_OF_RANGE,
                "bounds": NOT_CERTIFIED,
            },
        )


def prover_of_squares(cell: Cell) -> Prover[Any, Any, Any]:
    """What proves the least squares of a declared problem."""
    return accepting(SQUARES[Structure.of(cell)], cell)


def certified_squares(
    problem: RegistrationProblem, asked: Asked = USUAL, work: Work | None = None
) -> Registration:
    """The registration by least squares over all pairs, as `certify` returns it.

    Raises as `certify` does.
    """
    return prover_of_squares(problem.cell).certified(problem, asked, work or Work())


def solve(problem: RegistrationProblem, asked: Asked = USUAL) -> Solution:
    """Everything that is computed of the least squares, nothing yet checked."""
    prover, work = prover_of_squares(problem.cell), Work()
    return prover.prove(problem, prover.propose(problem, asked, work), asked, work)


def fitted(
    problem: RegistrationProblem, rows: Sequence[int], names: RowNames, asked: Asked
) -> Registration:
    """The registration of a problem whose pairs are some of others: `rows` says which.

    names: of the rows of all. asked: of the registration of these others.
    """
    about: dict[str, Any] = {"rows": list(rows)}
    if names.labels is not None:
        about["labels"] = [names.labels[row] for row in rows]
    return certified_squares(problem, replace(asked, about=about, not_taken=BY_NAME))
