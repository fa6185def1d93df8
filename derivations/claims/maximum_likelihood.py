"""Claim: the potential energy is the objective of maximum likelihood; the best translation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import sympy

from ..algebra import Square, combination, contraction, identity, positive
from ..hypotheses import MASSIVE, matched
from ..hypothesis import Standing, nonzero
from ..kernel import Claim, Mutation, Proof
from ..moments import MomentCloud
from ..motion import State, position, potential_energy
from ..notation import Array, gradient, inner, quaternion, rotation, square, vector

Translation = Callable[["Means", Array, Array], Array]


@dataclass(frozen=True)
class Means:
    """The weighted means of source and target, as they were given."""

    source: Array = field(default_factory=lambda: vector("xbar"))
    target: Array = field(default_factory=lambda: vector("ybar"))


def translation_of(means: Means, R: Array, c: Array) -> Array:
    """The translation t = mean(y) + c - R mean(x)."""
    return means.target + c - R * means.source


OFF = nonzero(
    r"$t \ne t^\star$.",
    vector("t") - translation_of(Means(), State().R, sympy.zeros(3, 1)),
    standing=Standing.CASE,
)
TURNED = matched()


def proof(translate: Translation = translation_of, *, energy: Any = potential_energy) -> Proof:
    """Residuals are the springs' extensions; then the objective, completed to a square in t."""
    state, cloud, means = State(), MomentCloud(), Means()
    x, y = cloud.x + means.source, cloud.y + means.target
    t = vector("t")
    yield identity(
        r"Write $x = \bar x + \tilde x$, $y = \bar y + \tilde y$. With "
        r"$t = \bar y + c - R\bar x$ the residual of a correspondence is the extension of its "
        r"spring, $y - Rx - t = \tilde y - R\tilde x - c$, for every matrix $R$.",
        y - state.R * x - translate(means, state.R, state.c),
        cloud.y - position(state, cloud.x),
    )
    objective = cloud.total(square(y - state.R * x - t))
    yield identity(
        r"So the objective $\sum m\,|y - Rx - t|^2$ with $m = 1/\sigma^2$ is the potential energy "
        r"$V_p$. For Gaussian noise of standard deviation $\sigma$ on every coordinate of $y$ the "
        r"negative logarithm of the likelihood is, by the definition of the density, half of it "
        r"plus a constant: minimal energy is maximum likelihood.",
        cloud.total(square(y - state.R * x - translate(means, state.R, state.c))),
        energy(state, cloud),
    )
    best = translate(means, state.R, sympy.zeros(3, 1))
    centred = energy(State(c=sympy.zeros(3, 1)), cloud)
    yield from _completed(objective, centred, t - best, cloud)
    yield from _cleared(translate)


def _completed(objective: Any, centred: Any, offset: Array, cloud: MomentCloud) -> Proof:
    yield identity(
        r"At a fixed matrix $R$ the objective is a square in $t$ about the best translation "
        r"$t^\star = \bar y - R\bar x$: it equals $V_p(R, c{=}0) + M\,|t - t^\star|^2$. The second "
        r"term is what the code reports for a translation that is not the best one.",
        objective,
        centred + cloud.mass * square(offset),
    )
    yield identity(
        r"Its gradient in $t$ is $2M(t - t^\star)$, which vanishes at $t^\star$ only.",
        gradient(objective, vector("t")),
        2 * cloud.mass * offset,
    )
    yield positive(
        r"So no translation does better than $t^\star$, and only $t^\star$ does as well: what "
        r"remains is to minimise $V_p(R, 0)$ over rotations.",
        objective - centred,
        [[MASSIVE[0], Square(entry)] for entry in OFF.parts],
    )


def _cleared(translate: Translation) -> Proof:
    means, q, M, a = Means(), quaternion(), MomentCloud().mass, vector("a")
    best = translate(means, State().R, sympy.zeros(3, 1))
    source, target = M * means.source, M * means.target
    shipped = square(q) * target - rotation(q) * source
    yield combination(
        r"The code computes $t^\star$ for an integer quaternion of any norm from the sums $\sum m "
        r"x = M\bar x$ and $\sum m y = M\bar y$, and divides at the end: $M|q|^2\,t^\star = "
        r"|q|^2\sum m y - \hat R(q)\sum m x$. Along any direction the difference is a combination "
        r"of the entries of $|q|^2R - \hat R(q)$, which vanishes for $R = R(q)$.",
        inner(a, M * square(q) * best - shipped),
        contraction(-a * source.T, TURNED),
    )


CLAIM = Claim(
    name="maximum_likelihood",
    title="Energy is likelihood",
    statement=r"With $m = 1/\sigma^2$ and $t = \bar y + c - R\bar x$ the potential energy is the "
    r"objective of maximum likelihood, $V_p = \sum m\,|y - Rx - t|^2$. At fixed $R$ its minimum "
    r"over $t$ is at $t^\star = \bar y - R\bar x$, where $c = 0$, and "
    r"$\sum m\,|y - Rx - t|^2 = V_p(R, 0) + M\,|t - t^\star|^2$. The code "
    r"computes $M|q|^2\,t^\star = |q|^2\sum m y - \hat R(q)\sum m x$ for $R = R(q)$.",
    concludes=(1, 2, 3, 4, 5, 6),
    hypotheses=(MASSIVE, OFF, TURNED),
    setting=(
        (
            r"The noise on $y$ is independent and Gaussian, of standard deviation $\sigma$ on "
            r"every coordinate."
        ),
    ),
    source="[Yang2020], the objective of registration and the potential energy",
    proof=proof,
    controls={
        "t with the mean of the source added": Mutation(
            at=1, proof=lambda: proof(lambda means, R, c: means.target + c + R * means.source)
        ),
        "t with the mean of the source not rotated": Mutation(
            at=1,
            proof=lambda: proof(lambda means, R, c: means.target + c - means.source + 0 * R * c),
        ),
        "springs of stiffness m": Mutation(
            at=2,
            proof=lambda: proof(energy=lambda state, cloud: potential_energy(state, cloud) / 2),
        ),
    },
    not_claimed="That the noise is Gaussian, or that noise on the source is accounted for. "
    "That the minimum over rotations is unique: see the claim `classification`.",
    needs=("potential_energy",),
    runs=("derivations.motion.potential_energy",),
    used_by=(
        "certreg.objective.isotropic.Isotropic.best_translation",
        "certreg.objective.isotropic.Isotropic.translation_energy",
    ),
    coq=(
        "potential_is_objective",
        "objective_reduction",
        "optimal_pose_iff",
    ),
    not_in_coq="Statistics: that the objective is the likelihood of Gaussian noise.",
)
