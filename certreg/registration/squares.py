"""The least squares over all pairs, or over some of them: which prover they have, by structure."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from certreg._loading import found_late
from certreg.objective.structure import Structure
from certreg.registration.pipeline import USUAL, Asked, Prover, Work, accepting
from certreg.results import Absent

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from certreg.problem.problem import RegistrationProblem
    from certreg.problem.support import Cell
    from certreg.registration.any_registration import AnySolution
    from certreg.registration.pipeline import Provers
    from certreg.registration.result import Registration
    from certreg.registration.row_names import RowNames
    from certreg.registration.spring_result import SpringRegistration

SQUARES: Mapping[Structure, Provers] = {
    Structure.LINEAR: (
        found_late("certreg.registration.linear", "RIGID"),
        found_late("certreg.registration.linear", "SIMILARITY"),
    ),
    Structure.QUARTIC: (found_late("certreg.registration.quartic", "PROVER"),),
}
BY_NAME = Absent(
    "with --max-residual it is taken only where it is named, of the pairs within: --solver NAME "
    "(relaxation), --integrator NAME (simulation)"
)


def prover_of_squares(cell: Cell) -> Prover[Any, Any, Any]:
    """What proves the least squares of a declared problem."""
    return accepting(SQUARES[Structure.of(cell)], cell)


def certified_squares(
    problem: RegistrationProblem, asked: Asked = USUAL, work: Work | None = None
) -> Any:
    """The registration by least squares over all pairs, as `certify` returns it.

    Raises as `certify` does.
    """
    return prover_of_squares(problem.cell).certified(problem, asked, work or Work())


def solve(problem: RegistrationProblem, asked: Asked = USUAL) -> AnySolution:
    """Everything that is computed of the least squares, nothing yet checked."""
    prover, work = prover_of_squares(problem.cell), Work()
    return prover.prove(problem, prover.propose(problem, asked, work), asked, work)


def fitted(
    problem: RegistrationProblem, rows: Sequence[int], names: RowNames, asked: Asked
) -> Registration | SpringRegistration:
    """The registration of a problem whose pairs are some of others: `rows` says which.

    names: of the rows of all. asked: of the registration of these others.
    """
    about: dict[str, Any] = {"rows": list(rows)}
    if names.labels is not None:
        about["labels"] = [names.labels[row] for row in rows]
    return certified_squares(problem, replace(asked, about=about, not_taken=BY_NAME))
