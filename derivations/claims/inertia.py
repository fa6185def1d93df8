"""Claim: the inertia matrix from the scatter, and when it is positive definite."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from certreg.problem.moments import inertia

from ..algebra import Square, identity, positive
from ..hypotheses import MASSES, moments
from ..hypothesis import Hypothesis, Standing, nonzero
from ..kernel import Claim, Mutation, Proof
from ..moments import MomentCloud, PointCloud, inertia_of
from ..notation import Array, Matrix, hat, square, vector

Formula = Callable[[Any], Any]


def _apart(n: int) -> Hypothesis:
    sources, a = PointCloud.of_size(n).sources, vector("a")
    return nonzero(
        r"One of the numbers $a\times(x_i - x_j)$ is not zero.",
        [entry for i, j in _pairs(n) for entry in a.cross(sources[i] - sources[j])],
        standing=Standing.CASE,
    )


def _pairs(n: int) -> list[tuple[int, int]]:
    return [(i, j) for j in range(n) for i in range(j)]


APART = {n: _apart(n) for n in (3, 4)}


def proof(of_scatter: Formula = inertia, *, share: int = 1) -> Proof:
    """J from the scatter; J as a sum of squares over points, and over pairs of points."""
    cloud, a = MomentCloud(), vector("a")
    J = Matrix(of_scatter(cloud.source_scatter.tolist()))
    yield identity(
        r"The inertia of the particles about their centre of mass is "
        r"$J = -\sum m\,[x]_\times^2$. Since $-[x]_\times^2 = |x|^2 I - xx^{\mathsf T}$, the sum "
        r"is $J = \operatorname{tr}(S_2)\,I - S_2$, the formula that the code computes.",
        -cloud.total(hat(cloud.x) * hat(cloud.x)),
        J,
    )
    yield identity(
        r"A check of the programs: the function that all other claims call computes this matrix.",
        inertia_of(cloud.source_scatter),
        J,
    )
    yield identity(
        r"Its quadratic form is $a^{\mathsf T}Ja = \sum m\,|a\times x|^2$: a sum of squares, so "
        r"$J$ is positive semidefinite. It vanishes for some $a \neq 0$ exactly if every centred "
        r"point is a multiple of $a$, that is, if all points lie on one line through their mean.",
        (a.T * J * a)[0],
        cloud.total(square(a.cross(cloud.x))),
    )
    yield identity(
        r"The mean can be left out: with the points in pairs, "
        r"$2M\,a^{\mathsf T}Ja = \sum_i\sum_j m_i m_j\,|a\times(x_i - x_j)|^2$. If "
        r"$a^{\mathsf T}Ja = 0$, all differences of points are parallel to $a$ and the points are "
        r"collinear. If the points lie on a line along $a$, all terms vanish. Hence $J \succ 0$ "
        r"if and only if three of the points are not collinear.",
        2 * share * cloud.mass * (a.T * J * a)[0],
        _over_pairs(a, cloud),
    )
    for n in (3, 4):
        yield _written_out(n, of_scatter)


def _over_pairs(a: Array, cloud: MomentCloud) -> Any:
    """The sum over i and j of m_i m_j |a x (x_i - x_j)|^2: the moment functional, twice."""
    other = MomentCloud(x=vector("u"), mass=cloud.mass, source_scatter=cloud.source_scatter)
    return other.total(cloud.total(square(a.cross(cloud.x - other.x))))


def _written_out(n: int, of_scatter: Formula) -> Any:
    """The same for n points about any origin, with S2 = (M sum m x x^T - sum m x sum m x^T) / M."""
    points, a = PointCloud.of_size(n), vector("a")
    about_origin, total = moments(points).source_scatter, points.total(points.sources)
    scatter = points.mass * about_origin - total * total.T
    J = Matrix(of_scatter(scatter.tolist()))
    terms = [
        [*(MASSES[n][k] for k in pair), Square(APART[n][3 * number + place])]
        for number, pair in enumerate(_pairs(n))
        for place in range(3)
    ]
    return positive(
        rf"Once more with $N = {n}$ points written out, about any origin, and with the integers of "
        r"the code, which hold $M S_2 = M\sum m\,xx^{\mathsf T} - \sum m\,x\,\sum m\,x^{\mathsf "
        r"T}$ in place of $S_2$: $M\,a^{\mathsf T}Ja = \sum_{i<j} m_i m_j\,|a\times(x_i - "
        r"x_j)|^2$. It is positive unless all these products are zero.",
        (a.T * J * a)[0],
        terms,
    )


CLAIM = Claim(
    name="inertia",
    title="The inertia matrix",
    statement=r"$J = -\sum m\,[x]_\times^2 = \operatorname{tr}(S_2)\,I - S_2$ and "
    r"$a^{\mathsf T}Ja = \sum m\,|a\times x|^2 = \frac1{2M}\sum_{i,j} m_i m_j\,|a\times(x_i - "
    r"x_j)|^2 \ge 0$. Moreover $J \succ 0$ if and only if three "
    r"points are not collinear.",
    concludes=(1, 3, 4, 5, 6),
    hypotheses=(MASSES[3], MASSES[4], APART[3], APART[4]),
    setting=(r"$x$ are the points about their mean.",),
    source="[Yang2020], the inertia matrix in the proposition on the dynamics",
    proof=proof,
    controls={
        "J = tr(S2) I + S2": Mutation(
            at=1,
            proof=lambda: proof(
                lambda S: Matrix(inertia(S)) + 2 * Matrix(S),
            ),
        ),
        "the scatter in place of the inertia": Mutation(at=1, proof=lambda: proof(lambda S: S)),
        "pairs counted once": Mutation(at=4, proof=lambda: proof(share=2)),
    },
    not_claimed="How well conditioned $J$ is: three points can be as nearly collinear as they "
    "like. Points of weight zero do not count as points.",
    runs=("certreg.problem.moments.inertia",),
    used_by=(
        "certreg.problem.moments.ExactMoments.inertia",
        "certreg.problem.moments.Moments.inertia",
        "certreg.objective.classification",
    ),
    coq=(
        "inertia_is_trace_minus_scatter",
        "inertia_form",
        "inertia_definite_iff",
        "solid_real",
    ),
    not_in_coq="Nothing: the whole claim is proved there, for weights that are not negative. "
    "`solid_real` decides it for the integers of a certificate.",
)
