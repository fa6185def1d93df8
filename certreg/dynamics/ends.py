"""Many bodies run to their ends, and what is known of these whatever the springs are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

from certreg.dynamics.integrators import integrate
from certreg.geometry import rotation_matrices
from certreg.native import Integrator
from certreg.results import Brief

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from certreg.dynamics.integrators import SimulationSettings
    from certreg.native import Batch, Records


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ManyEnds(Brief):
    """Where many bodies ended, and how: what `Ends` and `SpringEnds` have in common.

    status: (count,), numbers of an `Ending`; steps, escapes: (count,) integers; times: (count,), of
    the springs. states: (count,) records with the parts c, R for Euler, else q, v and omega.
    """

    integrator: Integrator
    status: NDArray[np.int32]
    steps: NDArray[np.int64]
    escapes: NDArray[np.int64]
    times: NDArray[np.float64]
    states: Records

    @classmethod
    def of(cls, batch: Batch, **own: Any) -> Self:
        """The ends of a batch that has run. own: what a kind of ends has beside these."""
        return cls(
            integrator=batch.integrator,
            status=batch.status,
            steps=batch.taken,
            escapes=batch.escapes,
            times=batch.times,
            states=batch.states,
            **own,
        )

    @property
    def rotations(self) -> NDArray[np.float64]:
        """The rotations at the ends, (count, 3, 3), body to world: target from source."""
        if self.integrator is Integrator.EULER:
            return self.states["R"]
        return rotation_matrices(self.states["q"])


def run_all(
    batch: Batch,
    settings: SimulationSettings,
    portion: int,
    progress: Callable[[int, int], object] | None,
) -> None:
    """Run every body of a batch to its end.

    portion: bodies, after which `progress` is called with how many are done and how many there are.
    """
    count = len(batch.states)
    portion = count or 1 if progress is None else portion
    for start in range(0, count, portion):
        integrate(batch.part(slice(start, start + portion)), settings)
        if progress is not None:
            progress(min(start + portion, count), count)
