"""Families of random instances along one parameter: what `parameter_sweeps` measures.

A module of its own: both together would be too long.

>>> import numpy as np
>>> sample = FAMILIES["symmetry"].sample(np.random.default_rng(0), 1e-3, 50)
>>> sample.sources.shape, sample.targets.shape
((50, 8, 3), (50, 8, 3))
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.geometry.so3 import davenport_matrix, rotation_matrices
from certreg.problem.random_instances import (
    PAPER_DAMPING,
    PAPER_POINTS,
    PAPER_SIGMA,
    gaussian_instances,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

SADDLE_DISTANCE = 1e-3  # radians: small enough for the linearised dynamics, far above rounding
NEAR_POINTS = 20  # of the clouds near degeneracy: any number of three and more does
LIMIT_DRAWS = 20_000  # of random matrices: the median is known to a per cent
LIMIT_POINTS = 10  # fewer are far from the limit of many
CUBE = np.array(list(product((1.0, -1.0), repeat=3)))  # second moments I, over the mass


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sample:
    """Instances of one value of the parameter.

    sources, targets: (count, N, 3). distance: radians from the best saddle, where an escape starts;
    from_saddle: whether the simulation starts there, too, and not at R = I. margins: (count,), as
    theory predicts them, NaN where it says nothing.
    """

    sources: NDArray[np.float64]
    targets: NDArray[np.float64]
    margins: NDArray[np.float64]
    damping: float = PAPER_DAMPING
    distance: float = SADDLE_DISTANCE
    from_saddle: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Family:
    """A parameter, its values, and instances for one of them.

    label: of an axis. points: N, None where it is the parameter.
    """

    name: str
    title: str
    label: str
    values: tuple[float, ...]
    points: int | None
    sample: Callable[[np.random.Generator, float, int], Sample]

    def size(self, value: float) -> int:
        """The number of points per cloud."""
        return int(value) if self.points is None else self.points

    @property
    def places(self) -> tuple[float, ...]:
        """The values on a logarithmic axis: zero a quarter of the axis before the others."""
        least = min(value for value in self.values if value > 0.0)
        before = least * (least / max(self.values)) ** 0.25
        return tuple(value or before for value in self.values)


def margin(C: NDArray[np.float64]) -> NDArray[np.float64]:
    """The least difference of neighbouring eigenvalues of K over the range, (...,).

    C: (..., 3, 3). As `equilibrium.Solutions.margins`, in doubles.
    """
    entries = [[C[..., i, j] for j in range(3)] for i in range(3)]
    K = np.array(davenport_matrix(entries))
    values = np.linalg.eigvalsh(np.moveaxis(K, (0, 1), (-2, -1)))
    gaps = np.diff(values, axis=-1)
    return np.asarray(gaps.min(axis=-1) / (values[..., -1] - values[..., 0]), dtype=np.float64)


def limit_margin(points: int, sigma: float) -> float:
    """The median margin of Gaussian instances of many points, by the central limit theorem.

    C / M is then R (I + (W + sigma G) / sqrt(N)), W symmetric with variances 2 on and 1 off the
    diagonal (the sample covariance), G with independent entries of variance 1 (the noise).
    """
    rng = np.random.default_rng(0)
    A, G = rng.standard_normal((2, LIMIT_DRAWS, 3, 3))
    W = (A + A.mT) / np.sqrt(2.0)
    return float(np.median(margin(np.eye(3) + (W + sigma * G) / np.sqrt(points))))


def broken(rng: np.random.Generator, value: float, count: int) -> Sample:
    """The corners of a cube, each moved by `value` times a Gaussian; without noise.

    To first order S2 = I + value (A + A^T) over the mass, A = mean of corner times move^T; its
    eigenvalues are the singular values of C, and the margin is half the least difference.
    """
    moves = rng.standard_normal((count, *CUBE.shape))
    sources = CUBE + value * moves
    targets = np.einsum("kij,knj->kni", _rotations(rng, count), sources)
    first = np.einsum("ni,knj->kij", CUBE, moves - moves.mean(axis=1, keepdims=True)) / len(CUBE)
    spread = np.linalg.eigvalsh(first + first.mT)
    predicted = value * np.diff(spread, axis=-1).min(axis=-1) / 2.0
    return Sample(sources=sources, targets=targets, margins=predicted)


def degenerate(rng: np.random.Generator, value: float, count: int) -> Sample:
    """Targets nearly mirrored: special singular values 2, 1, -(1 - value) of C over the mass.

    At zero the optima are a circle: d2 + d3 = 0. The eigenvalues of K are known, and the margin.
    """
    cloud = rng.standard_normal((count, NEAR_POINTS, 3))
    cloud -= cloud.mean(axis=1, keepdims=True)
    moments = np.asarray(cloud.mT @ cloud / NEAR_POINTS, dtype=np.float64)
    whitening = np.asarray(np.linalg.inv(np.linalg.cholesky(moments)), dtype=np.float64)
    sources = cloud @ whitening.mT  # of second moments I
    D = np.diag([2.0, 1.0, value - 1.0])
    C = _rotations(rng, count) @ D @ _rotations(rng, count)
    predicted = _constant(float(margin(D)), count)
    return Sample(sources=sources, targets=sources @ C.mT, margins=predicted)


def gaussian(
    rng: np.random.Generator,
    count: int,
    *,
    points: int = PAPER_POINTS,
    sigma: float = PAPER_SIGMA,
    limited: bool = True,
    **special: Any,
) -> Sample:
    """The paper's instances, with what is special of them.

    limited: whether a margin is predicted, as of many points.
    """
    made = gaussian_instances(rng, points=points, sigma=sigma, count=count)
    told = limited and points >= LIMIT_POINTS
    predicted = _constant(limit_margin(points, sigma) if told else np.nan, count)
    return Sample(sources=made.sources, targets=made.targets, margins=predicted, **special)


def _constant(value: float, count: int) -> NDArray[np.float64]:
    return np.full(count, value)


def _rotations(rng: np.random.Generator, count: int) -> NDArray[np.float64]:
    q = rng.standard_normal((count, 4))
    return rotation_matrices(q / np.linalg.norm(q, axis=1, keepdims=True))


def _decades(first: int, last: int, per_decade: int = 1) -> tuple[float, ...]:
    count = (last - first) * per_decade + 1
    return tuple(float(f"{v:.2g}") for v in np.logspace(first, last, count))


FAMILIES = {
    family.name: family
    for family in (
        Family(
            name="damping",
            title="Damping",
            label="damping μ",
            values=_decades(-1, 1, 6),
            points=PAPER_POINTS,
            sample=lambda rng, value, count: gaussian(rng, count, limited=False, damping=value),
        ),
        Family(
            name="noise",
            title="Noise",
            label="noise σ (clouds: 1)",
            values=(0.0, *_decades(-3, 1, 2)),
            points=PAPER_POINTS,
            sample=lambda rng, value, count: gaussian(rng, count, sigma=value),
        ),
        Family(
            name="points",
            title="Number of points",
            label="points N",
            values=(3.0, 4.0, 6.0, *_decades(1, 5, 2)),
            points=None,
            sample=lambda rng, value, count: gaussian(rng, count, points=int(value)),
        ),
        Family(
            name="symmetry",
            title="Symmetry, broken",
            label="moves of a cube's corners",
            values=(0.0, *_decades(-12, 0)),
            points=len(CUBE),
            sample=broken,
        ),
        Family(
            name="degeneracy",
            title="Distance to a mirror image",
            label="distance d₂ + d₃ (d₁ = 2)",
            values=_decades(-2, 0, 4),
            points=NEAR_POINTS,
            sample=degenerate,
        ),
        Family(
            name="start",
            title="Start near a saddle",
            label="radians from the best saddle",
            values=_decades(-10, 0),
            points=PAPER_POINTS,
            sample=lambda rng, value, count: gaussian(
                rng, count, limited=False, distance=value, from_saddle=True
            ),
        ),
    )
}
