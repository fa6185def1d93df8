"""Simulated trajectories in .npz files, bound by digest to the problem that they belong to."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from certreg.errors import InvalidFileError
from certreg.io import read_arrays, reading
from certreg.native import MATRIX_STATE, named, width
from certreg.verify import shown

if TYPE_CHECKING:
    import os

    from numpy.typing import NDArray

    from certreg.dynamics.simulation import Trajectory
    from certreg.problem import RegistrationProblem

ARRAYS = ("times", "states", "potential", "kinetic", "length_exponent", "damping", "digest")
LARGEST_STATE = 1e150  # of a position or velocity, in the body's unit: its square is a double
ORTHONORMAL = 1e-6  # of R^T R - I: what is integrated is projected at every step
LARGEST_EXPONENT = 1100  # of a unit of length: doubles reach from 2^-1074 to 2^1024


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Record:
    """A trajectory as it is kept: poses and energies, no points.

    times (L,); states (L, 18), potential and kinetic (L,) as in `certreg.Trajectory`.
    digest: of the problem, 64 hexadecimal digits. damping: mu, which no certificate holds.
    """

    times: NDArray[np.float64]
    states: NDArray[np.float64]
    potential: NDArray[np.float64]
    kinetic: NDArray[np.float64]
    length_exponent: int
    damping: float
    digest: str

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
        )

    def to_bytes(self) -> bytes:
        """The file's content, a .npz of ARRAYS; the digest as its 32 bytes."""
        buffer = io.BytesIO()
        np.savez_compressed(
            buffer,
            times=self.times,
            states=self.states,
            potential=self.potential,
            kinetic=self.kinetic,
            length_exponent=np.array(self.length_exponent),
            damping=np.array(self.damping),
            digest=np.frombuffer(bytes.fromhex(self.digest), dtype=np.uint8),
        )
        return buffer.getvalue()


def read_record(path: str | os.PathLike[str]) -> Record:
    """A trajectory that `certify --out` or `simulate --out` wrote. Raises InvalidFileError."""
    file = Path(path)
    with reading(file) as stream:
        arrays = read_arrays(stream, file, ARRAYS)
    count = arrays["times"].size
    shapes = dict.fromkeys(ARRAYS, ())
    shapes |= dict.fromkeys(("times", "potential", "kinetic"), (count,))
    shapes |= {"states": (count, width(MATRIX_STATE)), "digest": (32,)}
    wrong = [name for name in ARRAYS if arrays[name].shape != shapes[name]]
    if not wrong and count:
        wrong = _unsound(arrays)
    if wrong or count == 0:
        what = f"'{(wrong or ARRAYS)[0]}' is not that of a trajectory"
        message = f"{shown(file)}: {what}: write it anew with certreg simulate --out"
        raise InvalidFileError(message, path=file, column=(wrong or ARRAYS)[0])
    return Record(
        times=arrays["times"],
        states=arrays["states"],
        potential=arrays["potential"],
        kinetic=arrays["kinetic"],
        length_exponent=int(arrays["length_exponent"]),
        damping=float(arrays["damping"]),
        digest=bytes(map(int, arrays["digest"])).hex(),
    )


def _unsound(arrays: dict[str, NDArray[np.float64]]) -> list[str]:
    """The names of arrays whose numbers, finite as they are, no simulation gives."""
    times, states, exponent = (arrays[name] for name in ("times", "states", "length_exponent"))
    digest, sizes = arrays["digest"], np.abs(states)
    rotations = named(states, MATRIX_STATE)["R"]
    sound = {
        "times": times[0] == 0.0 and bool((np.diff(times) > 0.0).all()),
        "states": bool((sizes <= LARGEST_STATE).all())
        and bool((np.abs(_products(rotations) - np.eye(3)) <= ORTHONORMAL).all())
        and bool((np.linalg.det(rotations) > 0.0).all()),
        "length_exponent": exponent == np.rint(exponent) and abs(exponent) <= LARGEST_EXPONENT,
        "digest": bool(((digest == np.rint(digest)) & (digest >= 0) & (digest < 256)).all()),
    }
    return [name for name, holds in sound.items() if not holds]


def _products(rotations: NDArray[np.float64]) -> NDArray[np.float64]:
    """R^T R of each."""
    return np.einsum("lji,ljk->lik", rotations, rotations)
