"""The zoo: random and degenerate registration problems, each with what is known of it by proof."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from hypothesis import strategies as st

from certreg.problem.problem import RegistrationProblem

if TYPE_CHECKING:
    from numpy.typing import NDArray


def random_rotation(rng: np.random.Generator) -> NDArray[np.float64]:
    q = rng.normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def random_problem(
    rng: np.random.Generator,
    *,
    n: int = 20,
    noise: float = 0.01,
    offset: float = 0.0,
    scale: float = 1.0,
    decades: float = 0.0,
) -> RegistrationProblem:
    """The generator of the paper, with noise relative to the cloud, an offset, a scale, weights."""
    x = rng.normal(size=(n, 3))
    y = x @ random_rotation(rng).T + rng.normal(size=3) + noise * rng.normal(size=(n, 3))
    shift = offset * rng.normal(size=(2, 3))
    weights = 10.0 ** rng.uniform(-decades / 2, decades / 2, size=n)
    return RegistrationProblem((x + shift[0]) * scale, (y + shift[1]) * scale, weights=weights)


@dataclass(frozen=True)
class Specimen:
    """A cloud of exact coordinates whose row of the classification is proved by hand."""

    name: str
    source: list[list[float]]
    target: list[list[float]]
    pattern: tuple[int, ...]
    why: str

    @property
    def problem(self) -> RegistrationProblem:
        return RegistrationProblem(self.source, self.target)


def _mapped(points: list[list[float]], rows: list[list[float]]) -> list[list[float]]:
    return (np.array(points) @ np.array(rows).T).tolist()


TURN = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]  # a quarter turn, exact
MIRROR = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]

TETRAHEDRON = [[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]
TALL = [[1.0, 1, 2], [1, -1, -2], [-1, 1, -2], [-1, -1, 2]]  # tetrahedron stretched along z
FLAT = [[2.0, 2, 1], [2, -2, -1], [-2, 2, -1], [-2, -2, 1]]  # compressed along z
SQUARE = [[1.0, 1, 0], [1, -1, 0], [-1, -1, 0], [-1, 1, 0]]
RECTANGLE = [[2.0, 1, 0], [2, -1, 0], [-2, -1, 0], [-2, 1, 0]]
TRIANGLE = [[1.0, 0, 0], [0, 1, 0], [0, 0, 1]]  # regular, in exact coordinates
ISOSCELES = [[0.0, 3, 0], [1, 0, 0], [-1, 0, 0]]
CUBE = [[float(x), float(y), float(z)] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
OCTAHEDRON = [[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]
LINE = [[0.0, 0, 0], [1, 2, 3], [2, 4, 6], [5, 10, 15]]
BENT = [[0.0, 0, 0], [1, 2, 3], [2, 4, 7], [5, 9, 15]]
AXES = [[3.0, 0, 0], [-3, 0, 0], [0, 2, 0], [0, -2, 0], [0, 0, 1], [0, 0, -1]]  # C = diag(18, 8, 2)

ZOO = (
    Specimen("axes", AXES, _mapped(AXES, TURN), (1, 1, 1, 1), "d = 18, 8, 2 distinct"),
    Specimen("mirrored axes", AXES, _mapped(AXES, MIRROR), (1, 1, 1, 1), "d = 18, 8, -2"),
    Specimen("rectangle", RECTANGLE, RECTANGLE, (1, 1, 1, 1), "d = 16, 4, 0 distinct"),
    Specimen("isosceles", ISOSCELES, ISOSCELES, (1, 1, 1, 1), "d = 6, 2, 0 distinct"),
    Specimen("square", SQUARE, _mapped(SQUARE, TURN), (1, 2, 1), "d = 4, 4, 0"),
    Specimen("regular triangle", TRIANGLE, TRIANGLE, (1, 2, 1), "d = 1, 1, 0"),
    Specimen("mirrored flat", FLAT, _mapped(FLAT, MIRROR), (1, 2, 1), "d = 16, 16, -4"),
    Specimen("tall", TALL, _mapped(TALL, TURN), (1, 1, 2), "d = 16, 4, 4"),
    Specimen("tetrahedron", TETRAHEDRON, TETRAHEDRON, (1, 3), "d = 4, 4, 4"),
    Specimen("cube", CUBE, _mapped(CUBE, TURN), (1, 3), "d = 8, 8, 8"),
    Specimen("mirrored tall", TALL, _mapped(TALL, MIRROR), (2, 1, 1), "d = 16, 4, -4"),
    Specimen(
        "mirrored tetrahedron",
        TETRAHEDRON,
        _mapped(TETRAHEDRON, MIRROR),
        (3, 1),
        "d = 4, 4, -4",
    ),
    Specimen("collinear source", LINE, BENT, (2, 2), "rank one: d = d1, 0, 0"),
    Specimen("collinear target", BENT, LINE, (2, 2), "rank one: d = d1, 0, 0"),
    Specimen("two points", [[0.0, 0, 0], [1, 0, 0]], [[5.0, 5, 5], [5, 6, 5]], (2, 2), "rank one"),
    Specimen("coincident source", [[1.0, 2, 3]] * 4, BENT, (4,), "C = 0"),
    Specimen("coincident target", BENT, [[1.0, 2, 3]] * 4, (4,), "C = 0"),
    Specimen("one point", [[1.0, 2, 3]], [[4.0, 5, 6]], (4,), "C = 0"),
    Specimen(
        "cancelling octahedron",
        OCTAHEDRON,
        [[1.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 1, 0], [0, 0, 1], [0, 0, 1]],
        (4,),
        "antipodal vertices share a target: C = 0",
    ),
)


@st.composite
def problems(draw: st.DrawFn) -> RegistrationProblem:
    """Problems of every kind: generic, planar, collinear, coincident, symmetric, tiny, huge."""
    kind = draw(st.sampled_from(["random", "planar", "collinear", "coincident", "zoo"]))
    scale = 2.0 ** draw(st.integers(-300, 300))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    if kind == "zoo":
        specimen = draw(st.sampled_from(ZOO))
        return RegistrationProblem(
            np.array(specimen.source) * scale, np.array(specimen.target) * scale
        )
    n = draw(st.integers(1, 12))
    offset = 10.0 ** draw(st.integers(-3, 8))
    x = rng.normal(size=(n, 3))
    if kind == "planar":
        x[:, 2] = 0.0
    if kind == "collinear":
        x = rng.integers(-9, 9, size=(n, 1)) * np.array([[1.0, 2.0, 3.0]])
    if kind == "coincident":
        x = np.repeat(x[:1], n, axis=0)
    y = x @ random_rotation(rng).T + rng.normal(size=3) * offset
    y = y + draw(st.sampled_from([0.0, 0.01, 10.0])) * rng.normal(size=(n, 3))
    weights = 10.0 ** rng.uniform(-8, 8, size=n)
    return RegistrationProblem(x * scale, y * scale, weights=weights)
