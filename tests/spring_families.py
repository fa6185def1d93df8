"""Random problems with general springs: planes, lines, covariances, in the cells that are measured.

Each family is a noise model with springs to match. `cell` makes one problem; `CELLS` lists the
sizes and noises over which rates are stated, `MINIMAL` those that have several exact optima.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.random import Generator
    from numpy.typing import NDArray

    Springs = dict[str, NDArray[np.float64]]
    Maker = Callable[[Generator, int, float], "Instance"]

LONGEST = 100.0  # of the axes of `aniso`: deviations from s down to s/100


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Instance:
    """A problem as a user states it, and the pose that it was made with.

    springs: the keyword arguments of `RegistrationProblem` beside the clouds.
    """

    source: NDArray[np.float64]
    target: NDArray[np.float64]
    springs: Springs
    rotation: NDArray[np.float64]
    translation: NDArray[np.float64]


@dataclass(frozen=True, slots=True, order=True)
class Cell:
    """A family at one size and noise."""

    family: str
    n: int
    noise: float

    def __str__(self) -> str:
        return f"{self.family} N={self.n} s={self.noise:g}"


def uniform_rotation(rng: Generator) -> NDArray[np.float64]:
    """(3, 3), uniform over SO(3)."""
    w, x, y, z = (q := rng.standard_normal(4)) / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def directions(rng: Generator, n: int) -> NDArray[np.float64]:
    """(n, 3) unit vectors, uniform on the sphere."""
    rows = rng.standard_normal((n, 3))
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def _moved(
    rng: Generator,
    source: NDArray[np.float64],
    noise: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    springs: Springs,
) -> Instance:
    """A uniform pose; noise: of the points where they end, before they are disturbed."""
    rotation, translation = uniform_rotation(rng), rng.standard_normal(3)
    placed = source @ rotation.T + translation
    target = placed + noise(placed)
    return Instance(
        source=source, target=target, springs=springs, rotation=rotation, translation=translation
    )


def _isotropic(rng: Generator, s: float) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    return lambda placed: s * rng.standard_normal(placed.shape)


def plane(rng: Generator, n: int, s: float) -> Instance:
    """Point to plane: noise in every direction, normals at random."""
    springs = {"normals": directions(rng, n)}
    return _moved(rng, rng.standard_normal((n, 3)), _isotropic(rng, s), springs)


def line(rng: Generator, n: int, s: float) -> Instance:
    """Point to line."""
    springs = {"directions": directions(rng, n)}
    return _moved(rng, rng.standard_normal((n, 3)), _isotropic(rng, s), springs)


def mixed(rng: Generator, n: int, s: float) -> Instance:
    """A plane, a line, a point, in turn."""
    normals, along = directions(rng, n), directions(rng, n)
    normals[np.arange(n) % 3 != 0] = np.nan
    along[np.arange(n) % 3 != 1] = np.nan
    springs = {"normals": normals, "directions": along}
    return _moved(rng, rng.standard_normal((n, 3)), _isotropic(rng, s), springs)


def wall(rng: Generator, n: int, s: float) -> Instance:
    """Planes with normals along three orthogonal axes, of a cloud five times as wide."""
    axes = uniform_rotation(rng)
    springs = {"normals": axes[rng.integers(3, size=n)]}
    return _moved(rng, 5.0 * rng.standard_normal((n, 3)), _isotropic(rng, s), springs)


def _own_axes(
    rng: Generator, s: float, axes: NDArray[np.float64], deviations: NDArray[np.float64]
) -> tuple[Springs, Callable[[NDArray[np.float64]], NDArray[np.float64]]]:
    """Springs Q diag(s/d)^2 Q^T, and noise drawn from what they describe."""
    information = np.einsum("nij,nj,nkj->nik", axes, (s / deviations) ** 2, axes)
    information = (information + information.transpose(0, 2, 1)) / 2

    def noise(placed: NDArray[np.float64]) -> NDArray[np.float64]:
        drawn = deviations * rng.standard_normal(placed.shape)
        return np.einsum("nij,nj->ni", axes, drawn)

    return {"information": information}, noise


def aniso(rng: Generator, n: int, s: float) -> Instance:
    """Each pair with axes of its own, deviations from s down to s/100."""
    axes = np.array([uniform_rotation(rng) for _ in range(n)])
    deviations = s * np.exp(-rng.uniform(0.0, np.log(LONGEST), size=(n, 3)))
    springs, noise = _own_axes(rng, s, axes, deviations)
    return _moved(rng, rng.standard_normal((n, 3)), noise, springs)


def lidar(rng: Generator, n: int, s: float) -> Instance:
    """Rays from a scanner: 0.02 s along each, 0.001 s of the range across."""
    rays = rng.standard_normal((n, 3)) * (1.0, 1.0, 0.2)
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    ranges = rng.uniform(5.0, 50.0, size=n)
    source = ranges[:, np.newaxis] * rays
    rotation, translation = uniform_rotation(rng), rng.standard_normal(3)
    along = rays @ rotation.T  # the springs stand in the target's frame
    axes = np.linalg.qr(np.concatenate([along[:, :, None], rng.standard_normal((n, 3, 2))], 2))[0]
    deviations = s * np.stack([np.full(n, 0.02), 0.001 * ranges, 0.001 * ranges], axis=1)
    springs, noise = _own_axes(rng, s, axes, deviations)
    placed = source @ rotation.T + translation
    target = placed + noise(placed)
    return Instance(
        source=source, target=target, springs=springs, rotation=rotation, translation=translation
    )


def gicp(rng: Generator, n: int, s: float) -> Instance:
    """Flat covariances of both sides, summed and inverted; noise s, and 0.03 s along the normal."""
    normals = directions(rng, n)
    seen = normals + 0.1 * rng.standard_normal((n, 3))
    seen /= np.linalg.norm(seen, axis=1, keepdims=True)
    flat = [np.eye(3) - 0.999 * rows[:, :, None] * rows[:, None, :] for rows in (normals, seen)]
    information = np.linalg.inv(flat[0] + flat[1])
    information = (information + information.transpose(0, 2, 1)) / 2

    def noise(placed: NDArray[np.float64]) -> NDArray[np.float64]:
        drawn = s * rng.standard_normal(placed.shape)
        along = np.einsum("ni,ni->n", drawn, normals)
        return drawn - 0.97 * along[:, np.newaxis] * normals

    return _moved(rng, rng.standard_normal((n, 3)), noise, {"information": information})


FAMILIES: dict[str, Maker] = {
    "plane": plane,
    "line": line,
    "aniso": aniso,
    "gicp": gicp,
    "lidar": lidar,
    "mixed": mixed,
    "wall": wall,
}
SIZES: dict[str, tuple[tuple[int, ...], tuple[float, ...]]] = {
    "plane": ((7, 8, 10, 20, 100, 1000), (0.01, 0.1, 1.0)),
    "line": ((4, 5, 20, 100), (0.01, 0.1)),
    "aniso": ((3, 4, 10, 20, 100), (0.1,)),
    "gicp": ((4, 10, 20, 100, 1000), (0.1,)),
    "lidar": ((3, 10, 100, 1000), (1.0, 100.0)),
    "mixed": ((4, 6, 20), (0.1,)),
    "wall": ((20, 100), (0.1,)),
}
CELLS = tuple(
    Cell(family, n, noise)
    for family, (sizes, noises) in SIZES.items()
    for n in sizes
    for noise in noises
)
MINIMAL = (Cell("plane", 6, 0.0), Cell("line", 3, 0.0))  # several exact optima
LISTED = (  # of which all equilibria are listed
    *(Cell("plane", 6, s) for s in (0.0, 0.05)),
    *(Cell("plane", n, 0.05) for n in (7, 20, 100)),
    Cell("wall", 20, 0.05),
    Cell("line", 3, 0.05),
    Cell("line", 10, 0.05),
    Cell("aniso", 3, 0.05),
    Cell("aniso", 20, 0.05),
    Cell("gicp", 20, 0.05),
    Cell("lidar", 10, 1.0),
    Cell("mixed", 6, 0.05),
)


def instance(cell: Cell, seed: int) -> Instance:
    """A problem of the cell, the same for the same seed."""
    rng = np.random.default_rng([seed, cell.n, *map(ord, cell.family)])
    return FAMILIES[cell.family](rng, cell.n, cell.noise)


def statement(made: Instance) -> dict[str, Any]:
    """All arguments of `RegistrationProblem` by name."""
    return {"source": made.source, "target": made.target, **made.springs}
