"""Claim: the total force on the body."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy

from ..algebra import combination, contraction, identity
from ..hypotheses import BOTH_CENTRED, CENTRED, moments
from ..kernel import Claim, Mutation, Proof
from ..moments import MomentCloud, PointCloud
from ..motion import DAMPING, State, newton_euler, position, velocity
from ..notation import Array, gradient, hat, inner, square, vector

Force = Callable[[State, Any, Any], Array]
Total = Callable[[State, MomentCloud], Array]


def force_on_particle(state: State, x: Any, y: Any) -> Array:
    """The force on a particle of mass 1: spring 2 (y - R x - c), drag -mu (R (w x x) + v)."""
    return 2 * (y - position(state, x)) - DAMPING * velocity(state, x)


def closed_form(state: State, cloud: MomentCloud) -> Array:
    """The total force -2 M c - mu M v."""
    return -cloud.mass * (2 * state.c + DAMPING * state.v)


def proof(force: Force = force_on_particle, total: Total = closed_form) -> Proof:
    """The force on a particle from its spring's energy; the sum; the equation of motion."""
    state, cloud = State(), MomentCloud()
    place = vector("r")
    stored = square(cloud.y - place)
    pull = -gradient(stored, place).subs(dict(zip(place, position(state, cloud.x), strict=True)))
    yield identity(
        r"Per unit of mass a spring stores $|y - r|^2$, $r$ the particle's place. Its force is the "
        r"negative gradient in $r$, which is $2(y - r)$; with the drag $-\mu\dot r$ the force on "
        r"the particle at $r = Rx + c$ is $2(y - Rx - c) - \mu\,(R(\omega\times x) + v)$.",
        pull - DAMPING * velocity(state, cloud.x),
        force(state, cloud.x, cloud.y),
    )
    yield identity(
        r"Summed with the masses, everything linear in $x$ or $y$ vanishes, because both clouds "
        r"are taken about their means. The total force is $f = -2Mc - \mu M v$ for every matrix "
        r"$R$: the centre of mass hangs on one spring and does not feel the rotation.",
        cloud.total(force(state, cloud.x, cloud.y)),
        total(state, cloud),
    )
    for n in (3, 4):
        yield _written_out(n, force, total)
    yield identity(
        r"It is the right-hand side $Ma$ of Newton's equation that the other claims, and the "
        r"generated code, use.",
        newton_euler(state, cloud)[0],
        total(state, cloud),
    )


def _written_out(n: int, force: Force, total: Total) -> Any:
    points, state, a = PointCloud.of_size(n), State(), vector("a")
    pairs = zip(points.sources, points.targets, strict=True)
    summed = points.total([force(state, x, y) for x, y in pairs])
    weight = -(2 * sympy.eye(3) + DAMPING * hat(state.omega).T) * state.R.T * a
    return combination(
        rf"Once more with $N = {n}$ particles written out: along any direction $a$ the sum of the "
        r"forces less $f$ is a combination of the entries of $\sum m\,x$ and $\sum m\,y$.",
        inner(a, summed - total(state, moments(points))),
        [
            *contraction(weight, CENTRED[n, "x"]),
            *contraction(2 * a, CENTRED[n, "y"]),
        ],
    )


CLAIM = Claim(
    name="total_force",
    title="Total force",
    statement=r"$f = \sum m\,\bigl(2(y - Rx - c) - \mu\,(R(\omega\times x) + v)\bigr) = "
    r"-2Mc - \mu M v$ for every $3\times3$ matrix $R$.",
    concludes=(1, 2, 3, 4),
    hypotheses=BOTH_CENTRED,
    source="[Yang2020], the total force",
    proof=proof,
    controls={
        "springs of stiffness m": Mutation(
            at=1,
            proof=lambda: proof(
                force=lambda state, x, y: y - position(state, x) - DAMPING * velocity(state, x)
            ),
        ),
        "drag that drives": Mutation(
            at=2,
            proof=lambda: proof(
                total=lambda state, cloud: (
                    closed_form(state, cloud) + 2 * DAMPING * cloud.mass * state.v
                )
            ),
        ),
        "one spring for the whole mass": Mutation(
            at=2,
            proof=lambda: proof(
                total=lambda state, cloud: (
                    closed_form(state, cloud) + 2 * (cloud.mass - 1) * state.c
                )
            ),
        ),
    },
    not_claimed="That drag is physical: it is proportional to a particle's mass so that the sums "
    "close, as in the paper.",
    needs=("potential_energy",),
    runs=("derivations.motion.newton_euler",),
    used_by=(
        "derivations.motion.rate",
        "certreg.dynamics.rigid.RigidBody.rate",
    ),
    coq=("force_reduction",),
    not_in_coq="Nothing: the whole claim is proved there, for every matrix $R$.",
)
