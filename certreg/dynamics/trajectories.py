"""Simulated trajectories in .npz files, bound by digest to the problem that they belong to."""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.dynamics.trajectory import Trajectory
    from certreg.problem.problem import RegistrationProblem


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Record:
    """A trajectory as it is kept: poses and energies, no points.

    times (L,); states (L, 18), potential and kinetic (L,) as in `certreg.Trajectory`.
    digest: of the problem, 64 hexadecimal digits. damping: mu, which no certificate holds.
    scales: (L,), target over source, of a body whose scale is free; None of others.
    """

    times: NDArray[np.float64]
    states: NDArray[np.float64]
    potential: NDArray[np.float64]
    kinetic: NDArray[np.float64]
    length_exponent: int
    damping: float
    digest: str
    scales: NDArray[np.float64] | None = None

    @classmethod
    def of(cls, problem: RegistrationProblem, trajectory: Trajectory) -> Record:
        """What is kept of a trajectory of a problem."""
        return cls(
            times=trajectory.times,
            states=trajectory.states,
            potential=trajectory.potential,
            kinetic=trajectory.kinetic,
            length_exponent=trajectory.length_exponent,
            damping=problem.damping,
            digest=problem.digest(),
            scales=trajectory.scales,
        )

    def to_bytes(self) -> bytes:
        """The file's content, a .npz of these; the digest as its 32 bytes."""
        buffer = io.BytesIO()
        scales: dict[str, Any] = {} if self.scales is None else {"scales": self.scales}
        np.savez_compressed(
            buffer,
            times=self.times,
            states=self.states,
            potential=self.potential,
            kinetic=self.kinetic,
            length_exponent=np.array(self.length_exponent),
            damping=np.array(self.damping),
            digest=np.frombuffer(bytes.fromhex(self.digest), dtype=np.uint8),
            **scales,
        )
        return buffer.getvalue()
