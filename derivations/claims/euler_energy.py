"""Claim: the first step of explicit Euler from rest raises the total energy."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import sympy
from sympy import Rational

from ..algebra import Square, combination, contraction, facts, identity, nonnegative, positive
from ..hypotheses import IDENTITY, INERTIA_INVERSE, PRINCIPAL, SPECTRAL, STEPPED, moments
from ..hypothesis import Standing, nonzero
from ..integrators import STEP, euler_step
from ..kernel import Claim, Mutation, Proof, Step
from ..moments import PointCloud, inertia_of
from ..motion import (
    Body,
    State,
    kinetic,
    position,
    potential,
    rate,
    spring_torque,
    unit_cloud,
    velocity,
)
from ..notation import Array, Matrix, diagonal, inner, matrix, square, vector
from ..rings import rational
from .properness import solid_determinant, spin_terms

Stepped = Callable[[State, Body], Array]

REST = sympy.zeros(3, 1)
ACCELERATED = nonzero(
    r"The body is no equilibrium: $a \ne 0$.",
    vector("a"),
    standing=Standing.CASE,
    example={STEP: 1},
)


def energy(state: State, body: Body) -> Any:
    """(V_k + V_p) / M, from the expressions that are shipped."""
    return potential(state, body) + sum(kinetic(state, body))


def state_of(numbers: Array) -> State:
    """The state with the 18 numbers c, R row by row, v, omega."""
    return State(
        c=numbers[:3, :],
        R=Matrix(3, 3, list(numbers[3:12, :])),
        v=numbers[12:15, :],
        omega=numbers[15:, :],
    )


def proof(step: Stepped = euler_step, halves: int = 1) -> Proof:
    """What the first step does; what it adds to the energy; the sign; an example in numbers."""
    yield from _first_step(step, halves)
    yield from _positive()
    yield _example(step)


def _first_step(step: Stepped, halves: int) -> Proof:
    rest, body = State(v=REST, omega=REST), Body()
    found, rates = step(rest, body), rate(rest, body)
    a, alpha = rates[12:15, :], rates[15:, :]
    torque = spring_torque(rest, unit_cloud(body))
    yield identity(
        r"At rest the accelerations are $a = -2c$ and $\alpha = J^{-1}\tau$ with the springs' "
        r"torque $\tau$; there is no damping and no gyroscopic term. They are those of the shipped "
        r"right-hand side.",
        [*a, *alpha],
        [*(-2 * rest.c), *(body.inertia_inverse * torque)],
    )
    yield identity(
        r"Explicit Euler moves the pose with the old velocities, which are zero. So the first step "
        r"leaves $c$ and $R$ where they are (the projection has nothing to do), and the new "
        r"velocities are $ha$ and $h\alpha$.",
        found,
        Matrix([*rest.c, *rest.R, *(STEP * a), *(STEP * alpha)]),
    )
    spin = (alpha.T * body.inertia * alpha)[0]
    yield identity(
        r"The springs have given nothing, because no spring has changed its length, and yet the "
        r"body moves: $V/M$ grows by the kinetic energy $\tfrac{h^2}2\bigl(|a|^2 + "
        r"\alpha^{\mathsf T}J\alpha\bigr)$, exactly. Here $J$ stands for the inertia per unit of "
        r"mass, as in the code.",
        energy(state_of(found), body) - energy(rest, body),
        halves * STEP**2 * (square(a) + spin) / 2,
    )


def _positive() -> Proof:
    B, a, alpha = matrix("B"), vector("a"), vector("alpha")
    yield positive(
        r"That is never negative. With $S_2 = B^{\mathsf T}B$, rows $b_k$, and "
        r"$J = \operatorname{tr}(S_2)I - S_2$, it is $\tfrac{h^2}2\bigl(|a|^2 + "
        r"\sum_k |\alpha\times b_k|^2\bigr)$, and positive where a term is not zero, $a$ for "
        r"example.",
        STEP**2 / 2 * (square(a) + (alpha.T * inertia_of(B.T * B) * alpha)[0]),
        [
            [Rational(1, 2), Square(STEPPED[0]), Square(entry)]
            for entry in (
                *ACCELERATED.parts,
                *(spin for k in range(3) for spin in alpha.cross(B.row(k).T)),
            )
        ],
    )
    J = inertia_of(diagonal("d"))
    yield nonnegative(
        r"And with $J \succ 0$ it is zero only for $a = 0$ and $\alpha = 0$. In principal axes, "
        r"$(\operatorname{tr}J)^2\,\alpha^{\mathsf T}J\alpha - \det(J)\,|\alpha|^2$ multiplied out "
        r"has nonnegative terms only, and $\det J > 0$.",
        J.trace() ** 2 * (alpha.T * J * alpha)[0] - J.det() * square(alpha),
        spin_terms(alpha, PRINCIPAL.parts),
    )
    yield solid_determinant()
    rest, body, u = State(v=REST, omega=REST), Body(), vector("u")
    torque = spring_torque(rest, unit_cloud(body))
    yield combination(
        r"Then $c = -\tfrac12a = 0$, and $\tau = J\alpha = 0$: for every vector $u$, $u\cdot\tau - "
        r"(Ju)\cdot J^{-1}\tau$ is a combination of the entries of $JJ^{-1} - I$. So the energy "
        r"stays the same only at an equilibrium. From any other rest, at any step size $h > 0$ and "
        r"any damping, the first step of explicit Euler raises it.",
        inner(u, torque) - inner(body.inertia * u, body.inertia_inverse * torque),
        contraction(-u * torque.T, INERTIA_INVERSE),
    )


def _example(step: Stepped) -> Step:
    """A rhombus and the same turned by a right angle: the springs' and the particles' energies."""
    one = sympy.Integer(1)
    sources = (Matrix([2, 0, 0]), Matrix([-2, 0, 0]), Matrix([0, 1, 0]), Matrix([0, -1, 0]))
    quarter = Matrix([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    points = PointCloud((one,) * 4, sources, tuple(quarter * x for x in sources))
    cloud, mass = moments(points), points.mass
    inertia = inertia_of(cloud.source_scatter) / mass
    spread = (cloud.source_scatter + cloud.target_scatter).trace() / mass
    body = Body(cloud.cross / mass, inertia, inertia.inv(), spread)
    start = State(c=Matrix([1, 0, 0]), R=IDENTITY, v=REST, omega=REST)
    after = state_of(step(start, body).subs(STEP, Rational(1, 100)))
    before, then = _of_points(start, points), _of_points(after, points)
    return facts(
        r"For example, take the four points $(\pm2, 0, 0)$, $(0, \pm1, 0)$ with weight one, "
        r"registered to themselves turned by $90^\circ$ about $e_3$, the body at rest in $R = I$ "
        r"with $c = e_1$; $h = \tfrac1{100}$ as in the paper. Summed over springs and particles, "
        r"the energy is $24$ before the step and $24 + \tfrac7{2500}$ after it, the same with "
        r"every damping. Along the flow it never rises (claim `dissipation`).",
        [rational(value) for value in (before, then, _rise(body, start))],
        [24, 24 + Fraction(7, 2500), Fraction(7, 2500)],
    )


def _rise(body: Body, start: State) -> Any:
    """The rise by the formula, times the mass 4."""
    rates = rate(start, body)
    a, alpha = rates[12:15, :], rates[15:, :]
    return 4 * (square(a) + (alpha.T * body.inertia * alpha)[0]) / 20000


def _of_points(state: State, points: PointCloud) -> Any:
    """V_k + V_p as sums over the points."""
    pairs = list(zip(points.sources, points.targets, strict=True))
    stored = points.total([square(y - position(state, x)) for x, y in pairs])
    return stored + points.total([square(velocity(state, x)) for x in points.sources]) / 2


def _new_velocity_first(state: State, body: Body) -> Array:
    """Symplectic Euler in the translation: the centre moves with the new velocity."""
    found = euler_step(state, body)
    return Matrix([*(state.c + STEP * found[12:15, :]), *found[3:, :]])


def _half_the_torque(state: State, body: Body) -> Array:
    found = euler_step(state, body)
    return Matrix([*found[:15, :], *((state.omega + found[15:, :]) / 2)])


CLAIM = Claim(
    name="euler_energy",
    title="The energy of an explicit step",
    statement=r"The first step of explicit Euler from rest raises the total energy per unit of "
    r"mass, $V/M$, by exactly $\;\tfrac{h^2}2\bigl(|a|^2 + \alpha^{\mathsf T}J\alpha\bigr)$ with "
    r"the accelerations $a = -2c$, $\alpha = J^{-1}\tau$ and $J$ per unit of mass. If $J \succ 0$ "
    r"this is positive unless the body is at an equilibrium. So 'the total energy never "
    r"increases' is true of the flow and false of the scheme.",
    concludes=(1, 2, 3, 4, 6, 7, 8),
    hypotheses=(STEPPED, ACCELERATED, PRINCIPAL, INERTIA_INVERSE),
    setting=("The body starts at rest, as in the paper.",),
    source="[Yang2020], the section on simulation",
    proof=proof,
    controls={
        "the step with the new velocity in the centre": Mutation(
            at=2, proof=lambda: proof(_new_velocity_first)
        ),
        "half of the torque": Mutation(at=2, proof=lambda: proof(_half_the_torque)),
        "a rise by h^2 times the same": Mutation(at=3, proof=lambda: proof(halves=2)),
    },
    not_claimed="That explicit Euler does not converge: with small steps and enough damping it "
    "does. Nor that the energy rises in later steps, nor that the rise could be seen in a figure: "
    "in the example it is about a ten-thousandth of the energy at the start.",
    needs=("properness", "dissipation", "polar_projection"),
    standard=(SPECTRAL,),
    runs=("derivations.integrators.euler_step",),
    used_by=("certreg.dynamics.simulation.simulate",),
    not_in_coq="Nothing in Coq speaks of integrators.",
)
