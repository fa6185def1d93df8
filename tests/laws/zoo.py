"""Small seeded problems of every cell that the table accepts, and what plain sums say of them.

The loop is over the table: a cell that opens joins by itself. The reference knows NumPy alone: sums
over the points, each with the matrix that the data state, at whatever pose is given.
"""

from __future__ import annotations

import itertools
import zlib
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import spring_families
from same import problems
from same.problems import KINDS, NOISE, Problem, composed

import certreg
from certreg.problem.motion import Scale
from certreg.problem.support import Cell, Loss, supported

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    from certreg.problem.motion import Motion

    Array = NDArray[Any]

N = 12
LOSSES = (Loss.SQUARES, Loss.CONSENSUS, Loss.TRUNCATED)
WEIGHTS: dict[str, Callable[[np.random.Generator], dict[str, Any]]] = {
    "points": lambda _: {},
    "weights": lambda rng: {"weights": rng.uniform(0.5, 2.0, size=N)},
    "sigma": lambda rng: {"sigma": NOISE * rng.uniform(0.5, 2.0, size=N)},
}
SPRINGS = ("planes", "weighted planes", "lines", "covariances", "factors", "mixed")
DEGENERATE = (  # of which the pose is not always unique: what is proved holds all the same
    *("planar", "collinear", "symmetric", "repeated eigenvalues", "one to four pairs"),
    *("tiny", "huge", "far from the origin", "free translations"),
)
SIDES = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]  # of a symmetric matrix, as it is given


@dataclass(frozen=True, kw_only=True, eq=False)
class Specimen:
    """A problem of the zoo: its cell, and its data as a user states them."""

    name: str
    cell: Cell
    given: Problem
    generic: bool = True

    @property
    def options(self) -> dict[str, Any]:
        """Beside source and target, of `RegistrationProblem`."""
        return dict(self.given.statement)

    @property
    def motion(self) -> Motion:
        """What counts the parameters."""
        return self.problem.motion

    @property
    def n(self) -> int:
        return len(self.given.source)

    @cached_property
    def problem(self) -> certreg.RegistrationProblem:
        return certreg.RegistrationProblem(self.given.source, self.given.target, **self.options)

    @cached_property
    def result(self) -> Any:
        """What `certify` says, with all that it can say."""
        return certreg.certify(
            self.given.source, self.given.target, **self.options, **self.given.loss
        )

    @property
    def fit(self) -> Any:
        """The least squares: of all pairs, or of those within their bounds."""
        return self.result if self.cell.loss is Loss.SQUARES else self.result.fit

    @property
    def rows(self) -> Array:
        """The pairs of the least squares."""
        labels = self.result.labels or ("inlier",) * self.n
        return np.flatnonzero(np.array(labels) == "inlier")

    @property
    def value(self) -> float:
        """What is least, or largest: squares, pairs within, truncated squares."""
        names = {Loss.SQUARES: "objective", Loss.CONSENSUS: "lower", Loss.TRUNCATED: "cost"}
        return getattr(self.result, names[self.cell.loss])

    @cached_property
    def matrices(self) -> Array:
        """(N, 3, 3): W of sum (y - s R x - t)^T W (y - s R x - t), by what is stated."""
        rows = stated_matrices(self.options, self.n)
        return weights_of(self.options, self.n)[:, None, None] * rows

    def changed(self, **changes: Any) -> Specimen:
        """The same with other data, for a law that says what follows."""
        return Specimen(name=self.name, cell=self.cell, given=replace(self.given, **changes))


def weights_of(options: dict[str, Any], n: int) -> Array:
    sigma = options.get("sigma")
    given = options.get("weights", 1.0) if sigma is None else 1.0 / np.square(sigma)
    return np.broadcast_to(np.asarray(given, dtype=float), n)


def stated_matrices(options: dict[str, Any], n: int) -> Array:
    """Of planes n n^T, of lines I - d d^T, of covariances the inverse; without springs I."""
    made = np.broadcast_to(np.eye(3), (n, 3, 3)).copy()
    for name, read in READ.items():
        rows = np.asarray(options.get(name, np.full((n, 1), np.nan)))
        there = ~np.isnan(rows[:, 0])
        if there.any():
            made[there] = read(rows[there])
    return made


def symmetric(rows: Array) -> Array:
    whole = np.empty((len(rows), 3, 3))
    for (i, j), column in zip(SIDES, rows.T, strict=True):
        whole[:, i, j] = whole[:, j, i] = column
    return whole


def triangles(rows: Array) -> Array:
    whole = np.zeros((len(rows), 3, 3))
    for (j, i), column in zip(
        [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)], rows.T, strict=True
    ):
        whole[:, i, j] = column
    return whole


READ: dict[str, Callable[[Array], Array]] = {
    "normals": lambda rows: rows[:, :, None] * rows[:, None, :],
    "directions": lambda rows: np.eye(3) - rows[:, :, None] * rows[:, None, :],
    "covariances": lambda rows: np.linalg.inv(symmetric(rows)),
    "information": symmetric,
    "factors": lambda rows: triangles(rows) @ triangles(rows).transpose(0, 2, 1),
}
TURN: dict[str, Callable[[Array, Array], Array]] = {  # the target's frame turns these, too
    "normals": lambda rows, R: rows @ R.T,
    "directions": lambda rows, R: rows @ R.T,
    "covariances": lambda rows, R: _columns(R @ symmetric(rows) @ R.T),
    "information": lambda rows, R: _columns(R @ symmetric(rows) @ R.T),
    "factors": lambda rows, R: _lower(R @ READ["factors"](rows) @ R.T),
}


def _columns(whole: Array) -> Array:
    return np.stack([(whole[:, i, j] + whole[:, j, i]) / 2 for i, j in SIDES], axis=1)


def _lower(whole: Array) -> Array:
    L = np.linalg.cholesky(whole)
    return np.stack([L[:, i, j] for i in range(3) for j in range(i + 1)], axis=1)


@dataclass(frozen=True)
class Placement:
    """y = s R x + t."""

    rotation: Array
    translation: Array
    scale: float = 1.0

    @staticmethod
    def of(pose: Any) -> Placement:
        return Placement(pose.rotation, pose.translation, getattr(pose, "scale", 1.0))

    def moved(self, step: Array) -> Placement:
        """By (dt, phi, ds): R exp([phi])."""
        return Placement(
            self.rotation @ turn(step[3:6]), self.translation + step[:3], self.scale + step[6]
        )


def turn(phi: Array) -> Array:
    """exp([phi])."""
    angle = np.linalg.norm(phi)
    return problems.random_rotation(Axis(phi), float(angle)) if angle else np.eye(3)  # type: ignore[arg-type]


class Axis:
    """In the place of a generator, an axis that is given."""

    def __init__(self, phi: Array) -> None:
        self.q = np.array([0.0, *phi])

    def normal(self, size: int) -> Array:
        assert size == len(self.q)
        return self.q


def energy(one: Specimen, at: Placement, rows: Array | slice = slice(None)) -> float:
    """The objective, by its definition."""
    e = one.given.target - at.scale * one.given.source @ at.rotation.T - at.translation
    total = float(np.einsum("ki,kij,kj->", e[rows], one.matrices[rows], e[rows]))
    return total / at.scale if one.cell.scale is Scale.SYMMETRIC else total


def free(one: Specimen) -> list[int]:
    """Of (dt, phi, ds) what the motion leaves free."""
    shifts = [] if one.cell.rotation_only else [0, 1, 2]
    return [*shifts, 3, 4, 5, *([6] if one.cell.scaled else [])]


def slope(one: Specimen, at: Placement, rows: Array | slice, h: float = 1e-5) -> Array:
    """The gradient by central differences, of what is free."""
    steps = h * np.eye(7)[free(one)]
    return np.array(
        [
            (energy(one, at.moved(step), rows) - energy(one, at.moved(-step), rows)) / (2 * h)
            for step in steps
        ]
    )


def curvature(one: Specimen, at: Placement, rows: Array | slice, h: float = 1e-4) -> Array:
    """The Hessian by differences of the gradient, of what is free."""
    steps = h * np.eye(7)[free(one)]
    columns = [
        (slope(one, at.moved(step), rows, h) - slope(one, at.moved(-step), rows, h)) / (2 * h)
        for step in steps
    ]
    return (np.array(columns) + np.array(columns).T) / 2


def cells() -> Iterator[Cell]:
    """Those that `certify` accepts."""
    every = itertools.product((False, True), Scale, (False, True), LOSSES)
    return (cell for cell in map(Cell._make, every) if supported(cell))


def specimens(cell: Cell) -> Iterator[Specimen]:
    """One for each way to state the pairs of a cell; truncated squares weigh by their bounds."""
    motion: dict[str, Any] = {"rotation_only": True} if cell.rotation_only else {}
    motion |= {"scale": cell.scale.value} if cell.scaled else {}
    loss = None if cell.loss is Loss.SQUARES else cell.loss.value
    weighed = ("points",) if cell.loss is Loss.TRUNCATED else tuple(WEIGHTS)
    for terms in SPRINGS if cell.springs else weighed:
        name = " ".join([terms, *map(str, motion.values()), cell.loss.value])
        rng = np.random.default_rng(zlib.crc32(name.encode()))
        made = terms if cell.springs else "points"
        given = composed(rng, 0, terms=made, motion=motion, loss=loss, n=N)
        if not cell.springs:
            given = replace(given, statement={**given.statement, **WEIGHTS[terms](rng)})
        yield Specimen(name=name, cell=cell, given=given)


def degenerate() -> Iterator[Specimen]:
    """The second and the third of each kind of `make same` on which something is degenerate."""
    for kind, number in itertools.product(DEGENERATE, (1, 2)):
        rng = np.random.default_rng([40, zlib.crc32(kind.encode()), number])
        given = KINDS[kind].make(rng, number)
        options = given.statement
        cell = Cell(
            springs=bool(READ.keys() & options.keys()), scale=Scale(options.get("scale", "none"))
        )
        yield Specimen(name=f"{kind} {number}", cell=cell, given=given, generic=False)


def far_rays() -> Specimen:
    """Springs of a scanner, of deviations from centimetres to millimetres fifty metres away."""
    made = spring_families.lidar(np.random.default_rng(7), N, 0.05)
    information = _columns(made.springs["information"])
    given = Problem(source=made.source, target=made.target, statement={"information": information})
    return Specimen(name="rays of a scanner", cell=Cell(springs=True), given=given)


GENERIC = [*(one for cell in cells() for one in specimens(cell)), far_rays()]
ALL = [*GENERIC, *degenerate()]
SQUARES = [one for one in GENERIC if one.cell.loss is Loss.SQUARES]


def named(zoo: list[Specimen], **others: Sequence[Any]) -> dict[str, Any]:
    """For `pytest.mark.parametrize`; one problem of a cell always, of the others a sample.

    others: what else each problem is asked with, by its name: a list for all of them.
    """
    cases, seen = [], set[Cell]()
    for one in zoo:
        for values in itertools.product(*others.values()):
            marks = [pytest.mark.slow, pytest.mark.one_in(12)] if one.cell in seen else []
            name = " ".join([one.name, *map(str, values)])
            cases.append(pytest.param(one, *values, id=name, marks=marks))
            seen.add(one.cell)
    return {"argnames": ("one", *others), "argvalues": cases}
