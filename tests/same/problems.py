"""600 seeded problems of all kinds that certreg accepts; from NumPy and seeds alone.

Whatever moves within the package, both sides of `make same` get the same doubles. A kind is a name
of the table KINDS, with the number of its problems: terms, motion and loss of data with noise, then
data on which something is degenerate, then what takes many problems at once.
"""

from __future__ import annotations

import itertools
import math
import zlib
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from numpy.typing import NDArray

SEED = 40
QUICK = 10  # `QUICK=1` takes every tenth problem of a kind, and the first of each
NOISE = 0.01
CUBE = [[float(x), float(y), float(z)] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
OCTAHEDRON = [[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
TETRAHEDRON = [[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]
TALL = [[1.0, 1, 2], [1, -1, -2], [-1, 1, -2], [-1, -1, 2]]  # stretched: two eigenvalues alike
FLAT = [[2.0, 2, 1], [2, -2, -1], [-2, 2, -1], [-2, -2, 1]]
SQUARE = [[1.0, 1, 0], [1, -1, 0], [-1, -1, 0], [-1, 1, 0]]
TURN = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]  # a quarter turn, exact
MIRROR = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]


@dataclass(frozen=True, kw_only=True)
class Problem:
    """Two clouds, row i to row i, and what is said with them.

    `statement` are options of `RegistrationProblem`, `loss` those of `certify`. Another tool's
    `pose` is assessed, or its `labels` of wrong pairs. `call` says which function takes the data,
    `options` what else it takes.
    """

    source: NDArray[np.float64]
    target: NDArray[np.float64]
    statement: Mapping[str, Any] = field(default_factory=dict)
    loss: Mapping[str, Any] = field(default_factory=dict)
    pose: NDArray[np.float64] | None = None
    labels: NDArray[np.bool_] | None = None
    call: str = "certify"
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Kind:
    """How many problems there are of a kind, and how one is made: a generator, its number."""

    count: int
    make: Callable[[np.random.Generator, int], Problem]


def problems(*, quick: bool = False) -> Iterator[tuple[str, Problem]]:
    """Every problem with its name, `kind/number`."""
    for kind, entry in KINDS.items():
        for number in range(0, entry.count, QUICK if quick else 1):
            rng = np.random.default_rng([SEED, zlib.crc32(kind.encode()), number])
            yield f"{kind}/{number}", entry.make(rng, number)


# Terms, motion, loss ------------------------------------------------------------------------------


def composed(
    rng: np.random.Generator,
    number: int,
    *,
    terms: str = "points",
    motion: Mapping[str, Any] | None = None,
    loss: str | None = None,
    n: int | None = None,
) -> Problem:
    """Random data of a cell: noise of a hundredth; with a loss, three pairs in ten are wrong."""
    motion, n = motion or {}, n or 6 + number % 19
    source, rotation = rng.normal(size=(n, 3)), random_rotation(rng)
    scale = rng.uniform(0.5, 2.0) if "scale" in motion else 1.0
    shift = np.zeros(3) if motion.get("rotation_only") else rng.normal(size=3)
    target = scale * source @ rotation.T + shift + NOISE * rng.normal(size=(n, 3))
    near = random_rotation(rng, 10.0 ** -rng.integers(0, 8)) @ rotation
    statement = {**motion, **TERMS[terms](rng, n)}
    if loss is None:
        return Problem(
            source=source, target=target, statement=statement, pose=placed(near, shift, scale)
        )
    wrong = rng.permutation(n) < max(1, 3 * n // 10)
    moved = rng.normal(size=(n, 3))
    if loss == "truncated":  # the two points of a wrong pair are as far from the origin
        moved *= (np.linalg.norm(target, axis=1) / np.linalg.norm(moved, axis=1))[:, None]
    bounds = {"max_residual": 6.0 * NOISE}
    given = bounds if loss == "consensus" else {**bounds, "objective": loss}
    target = np.where(wrong[:, None], moved, target)
    return Problem(source=source, target=target, statement=statement, loss=given, labels=~wrong)


def _weights(rng: np.random.Generator, n: int) -> dict[str, Any]:
    """Weights over up to six decades, a noise for each pair, or one for all, and a damping."""
    decades = rng.uniform(0.0, 3.0)
    choices: tuple[dict[str, Any], ...] = (
        {"weights": 10.0 ** rng.uniform(-decades, decades, size=n)},
        {"sigma": NOISE * rng.uniform(0.5, 2.0, size=n)},
        {"sigma": NOISE},
        {"weights": rng.integers(0, 3, size=n) + (np.arange(n) < 4), "damping": 2.0},
    )
    return choices[rng.integers(len(choices))]


def _mixed(rng: np.random.Generator, n: int) -> dict[str, Any]:
    """Planes, lines and covariances by turns, and points where all of them are missing."""
    rows = rng.permutation(n) % 4
    given = {"normals": unit(rng, n), "directions": unit(rng, n), "covariances": _matrices(rng, n)}
    return {
        name: np.where((rows == k)[:, None], array, np.nan)
        for k, (name, array) in enumerate(given.items())
    }


def _matrices(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    """Positive definite matrices as xx, xy, xz, yy, yz, zz."""
    roots = np.eye(3) + 0.3 * rng.normal(size=(n, 3, 3))
    whole = NOISE**2 * roots @ roots.transpose(0, 2, 1)
    return np.stack([whole[:, i, j] for i in range(3) for j in range(i, 3)], axis=1)


def _factors(rng: np.random.Generator, n: int) -> dict[str, Any]:
    """l11, l21, l22, l31, l32, l33."""
    diagonal = np.isin(np.arange(6), (0, 2, 5))
    return {"factors": np.where(diagonal, 1.0, 0.0) + 0.2 * rng.normal(size=(n, 6))}


TERMS: dict[str, Callable[[np.random.Generator, int], dict[str, Any]]] = {
    "points": lambda rng, n: {},
    "weights": _weights,
    "planes": lambda rng, n: {"normals": unit(rng, n)},
    "weighted planes": lambda rng, n: {"normals": unit(rng, n), "weights": rng.uniform(1, 9, n)},
    "lines": lambda rng, n: {"directions": unit(rng, n)},
    "covariances": lambda rng, n: {"covariances": _matrices(rng, n)},
    "information": lambda rng, n: {"information": _matrices(rng, n)},
    "factors": _factors,
    "mixed": _mixed,
}


def random_rotation(rng: np.random.Generator, angle: float | None = None) -> NDArray[np.float64]:
    """A rotation of this angle about a random axis; without one, a random rotation."""
    q = rng.normal(size=4)
    if angle is not None:
        axis = q[1:] / np.linalg.norm(q[1:])
        q = np.array([math.cos(angle / 2), *(math.sin(angle / 2) * axis)])
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def unit(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    rows = rng.normal(size=(n, 3))
    return rows / np.linalg.norm(rows, axis=1)[:, None]


def whole(rng: np.random.Generator, largest: int) -> NDArray[np.float64]:
    """A shift in integers: no sum of such coordinates is rounded."""
    return rng.integers(-largest, largest + 1, size=3).astype(float)


def placed(
    rotation: NDArray[np.float64], shift: NDArray[np.float64], scale: float = 1.0
) -> NDArray[np.float64]:
    """The 4 x 4 matrix of a motion."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = scale * rotation, shift
    return pose


# What is degenerate -------------------------------------------------------------------------------


def _planar(rng: np.random.Generator, number: int) -> Problem:
    given = composed(rng, number, terms=("points", "weights")[number % 2])
    flat = np.array([1.0, 1.0, 0.0])
    return _changed(given, source=given.source * flat, target=given.target * flat)


def _collinear(rng: np.random.Generator, number: int) -> Problem:
    """Points of a line: in integers, then with noise."""
    steps = rng.integers(-9, 10, size=6 + number % 4).astype(float)
    source = np.outer(steps, [1.0, 2.0, float(1 + number % 3)])
    turned = source @ np.array(TURN).T + whole(rng, 4)
    target = turned if number % 2 else turned + NOISE * rng.normal(size=turned.shape)
    return Problem(source=source, target=target, pose=np.eye(4))


def _exact(shapes: tuple[Any, ...], rng: np.random.Generator, number: int) -> Problem:
    """A cloud of small integers and its exact image: shifted, turned or mirrored."""
    source = np.array(shapes[number % len(shapes)])
    matrix = (np.eye(3), np.array(TURN), np.array(MIRROR), -np.eye(3))[number // len(shapes) % 4]
    target = source @ matrix.T + whole(rng, 2)
    motion = {"scale": "symmetric"} if number % 5 == 4 else {}
    return Problem(source=source, target=target, statement=motion, pose=np.eye(4))


def _sized(decades: int, rng: np.random.Generator, number: int) -> Problem:
    """Both clouds at another size: weights, springs, a free scale by turns."""
    terms, motion = (
        ("points", {}),
        ("weights", {}),
        ("points", {"scale": "asymmetric"}),
        ("planes", {}),
    )[number % 4]
    given = composed(rng, number, terms=terms, motion=motion)
    size = 10.0 ** (decades + number % 3)
    pose = np.array(given.pose)
    pose[:3, 3] *= size
    return _changed(given, source=given.source * size, target=given.target * size, pose=pose)


def _offset(rng: np.random.Generator, number: int) -> Problem:
    given = composed(rng, number, terms=("weights", "planes", "covariances")[number % 3])
    shift = rng.normal(size=(2, 3)) * 10.0 ** (number % 8)
    return _changed(given, source=given.source + shift[0], target=given.target + shift[1])


def _few(rng: np.random.Generator, number: int) -> Problem:
    """One to four pairs: weights, then springs, then a rotation alone, then a free scale."""
    cells: tuple[tuple[str, dict[str, Any]], ...] = (
        *(("points", {}), ("weights", {}), ("planes", {}), ("lines", {}), ("covariances", {})),
        *(("points", {"rotation_only": True}), ("points", {"scale": "asymmetric"})),
        ("points", {"scale": "symmetric"}),
    )
    terms, motion = cells[number // 4 % len(cells)]
    return composed(rng, number, terms=terms, motion=motion, n=1 + number % 4)


def _free(rng: np.random.Generator, number: int) -> Problem:
    """Springs that leave something undetermined: normals that are parallel, or in one plane."""
    given = composed(rng, number, terms="planes")
    kept = (np.array([0.0, 0.0, 1.0]), np.array([1.0, 1.0, 0.0]))[number % 2]
    normals = given.statement["normals"] * kept
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return _changed(given, statement={"normals": normals})


def _poor(rng: np.random.Generator, number: int) -> Problem:
    """A fit with a warning, or nearly: mirrored, other scale, other order, outliers, much noise.

    Of every ten by a smaller amount, so that some are on either side of a level.
    """
    given = composed(rng, number, terms=("points", "planes")[number // 5 % 2], n=12)
    source, target = given.source, given.target
    amount = (1.0, 0.02, 0.01, 0.005)[number // 10]
    shift = np.where(np.arange(12)[:, None] < 2, 3.0 * amount, 0.0)
    changed = (
        (-source, target),
        ((1.0 + amount) * source, target),
        (np.roll(source, 1, axis=0), target),
        (source, target + shift),
        (source, target + 0.5 * amount * rng.normal(size=target.shape)),
    )[(number + number // 10) % 5]
    statement = {**given.statement, "sigma": NOISE} if number % 2 else given.statement
    return _changed(given, source=changed[0], target=changed[1], statement=statement)


def _changed(given: Problem, **others: Any) -> Problem:
    return Problem(**{**vars(given), **others})


# Many at once, and bounds that shrink -------------------------------------------------------------


def _stack(call: str, rng: np.random.Generator, number: int) -> Problem:
    """Eight problems as arrays (8, N, 3), with weights or springs of their own."""
    terms = {"solve_many": "points", "certify_many": "points"}.get(call)
    springs = ("planes", "lines", "covariances")[number % 3]
    n = 7 + number % 5
    each = [composed(rng, number, terms=terms or springs, n=n) for _ in range(8)]
    options = {name: np.stack([one.statement[name] for one in each]) for name in each[0].statement}
    if call == "solve_many":
        options["weights"] = rng.uniform(0.5, 2.0, size=(8, n))
    return Problem(
        source=np.stack([one.source for one in each]),
        target=np.stack([one.target for one in each]),
        call=call,
        options=options,
    )


def _breaking(rng: np.random.Generator, number: int) -> Problem:
    given = composed(rng, number, loss="consensus", n=5 + number % 3)
    return _changed(given, call="breaking", loss={"max_residual": 10.0 * NOISE}, labels=None)


def _listed(rng: np.random.Generator, number: int) -> Problem:
    """Three pairs of clouds for `certreg batch`, one of which is refused."""
    given = [composed(rng, number, n=6) for _ in range(3)]
    source = np.stack([one.source for one in given])
    source[2] = math.nan
    return Problem(source=source, target=np.stack([one.target for one in given]), call="batch")


def _cells() -> Iterator[tuple[str, Kind]]:
    """The cells of terms, motion and loss, each with its number of problems."""
    for name, count in SPRINGS.items():
        yield name, Kind(count, partial(composed, terms=name))
    for (name, motion), terms in itertools.product(MOTIONS.items(), ("points", "weights")):
        yield f"{terms}, {name}", Kind(14, partial(composed, terms=terms, motion=motion))
    for name, count in WRONG.items():
        yield f"{name}, wrong pairs", Kind(count, partial(composed, terms=name, loss="consensus"))
    for name in ("asymmetric", "symmetric"):
        make = partial(composed, motion=MOTIONS[name], loss="consensus")
        yield f"points, {name}, wrong pairs", Kind(10, make)
    make = partial(composed, motion=MOTIONS["rotation"], loss="truncated")
    yield "points, rotation, truncated", Kind(12, make)


SPRINGS = {  # how many problems there are of these terms
    **dict.fromkeys(("planes", "lines", "covariances", "mixed"), 22),
    "points": 15,
    "weights": 30,
    "weighted planes": 15,
    "information": 10,
    "factors": 10,
}
WRONG = {"points": 21, "planes": 15, "lines": 10, "covariances": 10, "mixed": 10}
MOTIONS: dict[str, dict[str, Any]] = {
    "rotation": {"rotation_only": True},
    "asymmetric": {"scale": "asymmetric"},
    "symmetric": {"scale": "symmetric"},
    "asymmetric rotation": {"scale": "asymmetric", "rotation_only": True},
    "symmetric rotation": {"scale": "symmetric", "rotation_only": True},
}
KINDS: dict[str, Kind] = {
    **dict(_cells()),
    "many pairs": Kind(6, partial(composed, terms="points", n=5000)),
    "many planes": Kind(4, partial(composed, terms="planes", n=3000)),
    "planar": Kind(12, _planar),
    "collinear": Kind(10, _collinear),
    "symmetric": Kind(12, partial(_exact, (CUBE, OCTAHEDRON, TETRAHEDRON))),
    "repeated eigenvalues": Kind(12, partial(_exact, (TALL, FLAT, SQUARE))),
    "tiny": Kind(8, partial(_sized, -120)),
    "huge": Kind(8, partial(_sized, 120)),
    "far from the origin": Kind(12, _offset),
    "one to four pairs": Kind(32, _few),
    "free translations": Kind(8, _free),
    "poor fit": Kind(40, _poor),
    "many solved": Kind(5, partial(_stack, "solve_many")),
    "many springs solved": Kind(6, partial(_stack, "solve_many_springs")),
    "many certified": Kind(5, partial(_stack, "certify_many")),
    "many simulated": Kind(6, partial(_stack, "simulate_many")),
    "breaking": Kind(6, _breaking),
    "list": Kind(2, _listed),
}
