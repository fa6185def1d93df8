"""Claim: a translation that is off by d costs exactly M |d|^2, at every rotation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import combinations
from typing import Any

import numpy as np

from certreg.geometry.so3 import dot, rotation_matrix, squared_norm
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem

from ..algebra import Square, facts, identity, positive
from ..hypotheses import MASSIVE
from ..hypothesis import Standing, nonzero
from ..kernel import Claim, Mutation, Proof, Step
from ..moments import MomentCloud, PointCloud
from ..notation import gradient, matrix, square, vector

TranslationEnergy = Callable[[Any, Sequence[int], Sequence[Fraction]], Fraction]
SOURCE = ((1, 0, 2), (-3, 4, 0), (0, 5, 1), (2, 2, -7))
TARGET = ((8, 1, 0), (0, -2, 4), (16, 4, 4), (12, 0, -8))
WEIGHTS = (1, 2, 4, 3)
QUATERNIONS = ((1, 0, 0, 0), (1, 2, 3, 4), (0, 5, -1, 2))
TRANSLATION = (Fraction(1, 2), Fraction(-3), Fraction(5, 7))


R, T = matrix("R"), vector("t")
SHIFTED = nonzero(
    r"$t \ne \bar y - R\bar x$.",
    T - vector("ybar") + R * vector("xbar"),
    standing=Standing.CASE,
)


def proof(
    shipped: TranslationEnergy = Isotropic.translation_energy, mean_sign: int = 1, weight: int = 1
) -> Proof:
    """The square completed: by moments, again for 3 and 4 points, and the code on an instance."""
    t, cloud = T, MomentCloud()
    x_mean, y_mean = vector("xbar"), vector("ybar")
    best = y_mean - mean_sign * R * x_mean
    residual = cloud.y + y_mean - R * (cloud.x + x_mean) - t
    objective = cloud.total(square(residual))
    least = cloud.total(square(cloud.y - R * cloud.x))
    yield identity(
        r"The objective at $R$ and any $t$ is the moment of $|y - R x - t|^2$ with "
        r"$x = \tilde x + \bar x$, $y = \tilde y + \bar y$. The centred points sum to zero, so it "
        r"is the moment of $|\tilde y - R \tilde x|^2$ plus $M |t - (\bar y - R \bar x)|^2$: an "
        r"identity, for every matrix $R$ and every number of points.",
        objective,
        least + weight * cloud.mass * square(t - best),
    )
    yield identity(
        r"Its gradient in $t$ is $2 M (t - (\bar y - R\bar x))$. As $M > 0$ it vanishes at "
        r"$t = \bar y - R\bar x$ only, which is the best translation for this $R$.",
        gradient(objective, t),
        2 * cloud.mass * (t - best),
    )
    yield positive(
        r"Any other translation costs more: the difference is $M$ times a sum of squares, and "
        r"positive.",
        objective - least,
        [[MASSIVE[0], Square(entry)] for entry in SHIFTED.parts],
    )
    for n in (3, 4):
        yield _written_out(n)
    found = [_told(shipped, q) for q in QUATERNIONS]
    yield facts(
        r"The shipped functions, on four weighted points with different scales for source and "
        r"target, at three integer quaternions and a rational translation: "
        r"`energy` plus `translation_energy` of `certreg.objective.isotropic.Isotropic` is the sum "
        r"over the points of $w\,|y - R x - t|^2$, computed directly in fractions.",
        found,
        [_summed(q) for q in QUATERNIONS],
    )


def _written_out(n: int) -> Step:
    """M times the objective of n points with everything a symbol: nothing centred, no division."""
    cloud, t = PointCloud.of_size(n), T
    pairs = tuple(zip(cloud.sources, cloud.targets, strict=True))
    residuals = tuple(y - R * x - t for x, y in pairs)
    apart = [
        cloud.masses[i] * cloud.masses[j] * square(pairs[i][1] - pairs[j][1] - R * turned)
        for i, j in combinations(range(n), 2)
        for turned in [pairs[i][0] - pairs[j][0]]
    ]
    offset = cloud.total(cloud.targets) - R * cloud.total(cloud.sources) - cloud.mass * t
    return identity(
        rf"Once more for $N = {n}$, everything written out and without division: $M$ times the "
        r"objective is $\sum_{i<j} m_i m_j |(y_i - y_j) - R (x_i - x_j)|^2$, in which there is no "
        r"translation, plus $|M (\bar y - R \bar x - t)|^2$.",
        cloud.mass * cloud.total(tuple(square(r) for r in residuals)),
        sum(apart) + square(offset),
    )


def _told(shipped: TranslationEnergy, q: Sequence[int]) -> Fraction:
    problem = RegistrationProblem(np.array(SOURCE), np.array(TARGET), weights=np.array(WEIGHTS))
    objective = Isotropic(exact_moments(problem))
    return objective.energy(q) + shipped(objective, q, TRANSLATION)


def _summed(q: Sequence[int]) -> Fraction:
    norm, rows = squared_norm(q), rotation_matrix(q)
    total = Fraction(0)
    for x, y, w in zip(SOURCE, TARGET, WEIGHTS, strict=True):
        moved = [Fraction(dot(row, x), norm) + t for row, t in zip(rows, TRANSLATION, strict=True)]
        total += w * sum((a - b) ** 2 for a, b in zip(y, moved, strict=True))
    return total


def _without_the_mean(objective: Isotropic, _q: Sequence[int], t: Sequence[Fraction]) -> Fraction:
    """The target's mean taken for the best translation."""
    moments = objective.moments
    offset = [a - b for a, b in zip(t, moments.target_centroid, strict=True)]
    return moments.total_weight * sum(d * d for d in offset)


CLAIM = Claim(
    name="translation_gap",
    title="What a translation costs",
    statement=r"For every rotation $R$ and translation $t$, "
    r"$$\sum_i m_i |y_i - R x_i - t|^2 = \min_{t'} \sum_i m_i |y_i - R x_i - t'|^2 + M\,|d|^2, "
    r"\qquad d = t - (\bar y - R \bar x),$$ and the minimum is attained at $t' = \bar y - R\bar x$ "
    r"only. `translation_energy` of the code is $M\,|d|^2$.",
    concludes=(1, 2, 3, 4, 5, 6),
    hypotheses=(MASSIVE, SHIFTED),
    setting=("$R$ may be any matrix.",),
    source="objective of [Yang2020], its translation eliminated as in [Horn1987]",
    proof=proof,
    controls={
        "the best translation as ybar + R xbar": Mutation(at=1, proof=lambda: proof(mean_sign=-1)),
        "a cost of 2 M |d|^2": Mutation(at=1, proof=lambda: proof(weight=2)),
        "shipped code that forgets R xbar": Mutation(
            at=6, proof=lambda: proof(shipped=_without_the_mean)
        ),
    },
    not_claimed=r"That the translation a user reads is $\bar y - R \bar x$ exactly: it is rounded "
    r"to doubles, and its exact cost is what `translation_energy` returns.",
    needs=("maximum_likelihood",),
    used_by=(
        "certreg.objective.isotropic.Isotropic.best_translation",
        "certreg.objective.isotropic.Isotropic.translation_energy",
        "certreg.certificate.bounds.pose_energy",
    ),
    coq=(
        "objective_reduction",
        "optimal_pose_iff",
    ),
    not_in_coq="The formula for a matrix $R$ that is no rotation.",
)
