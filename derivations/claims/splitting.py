"""Claim: the splitting is consistent, rests exactly at the equilibria, and is conformal."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

import sympy
from sympy import Rational

from ..algebra import Square, combination, contraction, identity, modulo, positive
from ..hypotheses import DAMPED, INERTIA_INVERSE, STEPPED, UNIT, inverted
from ..hypothesis import Point, Standing, equation, nonzero, positive_by, vanishing
from ..integrators import (
    DECAY,
    IMPULSE,
    STEP,
    QuaternionState,
    accelerations,
    drift,
    kick,
    quaternion_torque,
    splitting_step,
    squared_speed,
)
from ..kernel import Claim, Mutation, Proof, Step
from ..motion import DAMPING, Body, State, rate
from ..notation import (
    Array,
    Matrix,
    body,
    entry,
    hat,
    inner,
    jacobian,
    left_product,
    quaternion,
    rotation,
    scalar,
    square,
    vector,
)

Kick = Callable[[QuaternionState, Body], tuple[Array, Array]]
Drift = Callable[[Any, Any], Array]

STATE, BODY = QuaternionState(), Body()
AT_REST = QuaternionState(v=sympy.zeros(3, 1), omega=sympy.zeros(3, 1))
PUSHED = positive_by(
    r"$i = (1 - e^{-\mu h})/\mu > 0$, as $\mu > 0$ and $h > 0$.",
    IMPULSE,
)
DECAYING = vanishing(
    r"$e = e^{-\mu h}$ and $i = (1 - e)/\mu$: $\mu i + e = 1$.",
    DAMPING * IMPULSE + DECAY - 1,
    solves=(DECAY,),
)


def _turned_by_one_axis(point: Point) -> Mapping[Any, Any]:
    """Rational h, omega and n with n^2 = 1 + h^2 |omega|^2 / 4, omega along the first axis."""
    share = point[STATE.omega[0]] / 8
    spin = 4 * share / (1 - share**2)
    known = {STATE.omega[0]: spin, STATE.omega[1]: 0, STATE.omega[2]: 0}
    return known | {STEP: 1, scalar("n"): (1 + share**2) / (1 - share**2)}


LENGTH = equation(
    r"$n$ is the length of the drift, $n^2 = 1 + \tfrac{h^2}4|\omega'|^2$.",
    scalar("n"),
    2,
    1 + STEP**2 * square(STATE.omega) / 4,
    standing=Standing.CASE,
    prepare=_turned_by_one_axis,
)
APART = nonzero(r"$c \ne 0$.", STATE.c, standing=Standing.CASE)
STABLE = positive_by(
    r"For stability: $hi < 1 + e$.", 1 + DECAY - STEP * IMPULSE, standing=Standing.CASE
)


def quaternion_equations() -> Step:
    """The step that the accelerations in quaternions are those of the paper's equations."""
    as_matrix = State(c=STATE.c, R=rotation(STATE.q), v=STATE.v, omega=STATE.omega)
    return identity(
        r"The shipped accelerations in quaternions are the paper's, with $\hat R(q)$ for $R$: "
        r"$\dot v = -2c - \mu v$ and $\dot\omega = J^{-1}\bigl(2L(q)^{\mathsf T}Kq - \omega\times "
        r"J\omega\bigr) - \mu\omega$. For $|q| = 1$ that is $R(q)$.",
        [entry for part in accelerations(STATE, BODY) for entry in part],
        rate(as_matrix, BODY)[12:, :],
    )


def proof(kicked: Kick = kick, drifted: Drift = drift) -> Proof:
    """Both halves of the step; the equations; consistency; rest; the translation."""
    yield from _kick(kicked)
    yield from _drift(drifted)
    yield quaternion_equations()
    yield _speed()
    yield from _consistent(kicked, drifted)
    yield from _rests(kicked, drifted)
    yield from _translation(kicked)


def _speed() -> Step:
    linear, angular = accelerations(STATE, BODY)
    turning = rotation(STATE.q) * hat(STATE.omega)
    return modulo(
        r"The speed in the stopping rule is the norm of the paper's 18 rates: the nine of $R$ "
        r"contribute $\lVert R[\omega]_\times\rVert^2 = 2|\omega|^2$ where $|q| = 1$.",
        squared_speed(STATE, BODY) - square(linear) - square(angular),
        square(STATE.v) + square(turning),
        [UNIT],
    )


def _kick(kicked: Kick) -> Proof:
    ends = Matrix.vstack(*kicked(STATE, BODY))
    slope = -DAMPING * DECAY * ends.diff(DECAY) + DECAY * ends.diff(IMPULSE)
    torque = quaternion_torque(STATE.q, BODY) - STATE.omega.cross(BODY.inertia * STATE.omega)
    frozen = Matrix([*(-2 * STATE.c), *(BODY.inertia_inverse * torque)])
    b = Matrix([*vector("b"), *vector("d")])
    yield combination(
        r"The kick holds the forces, $f = (-2c,\ J^{-1}(\tau - \omega\times J\omega))$, and solves "
        r"$\dot z = f - \mu z$ exactly. With $e = e^{-\mu h}$ and $i = (1 - e)/\mu$, whose "
        r"derivatives in $h$ are $-\mu e$ and $e$, the new velocities $z = ez_0 + if$ obey it: the "
        r"difference is $(f\cdot b)(\mu i + e - 1)$, for every $b$.",
        inner(b, slope + DAMPING * ends - frozen),
        [(inner(b, frozen), DECAYING[0])],
    )
    yield identity(
        r"And at $h = 0$, where $e = 1$ and $i = 0$, they are the old ones.",
        ends.subs({DECAY: 1, IMPULSE: 0}),
        Matrix([*STATE.v, *STATE.omega]),
    )


def _drift(drifted: Drift) -> Proof:
    q, omega = STATE.q, STATE.omega
    moved, turn = drifted(q, omega), Matrix([1, *(STEP / 2 * omega)])
    yield identity(
        r"The drift $q + \tfrac h2L(q)\,\omega$ is longer than $q$, $|q|^2(1 + "
        r"\tfrac{h^2}4|\omega|^2)$, so it is never zero and can be normalised. It is the product "
        r"of $q$ with $(1, \tfrac h2\omega)$: a turn about $\omega$ in the body frame.",
        [square(moved), *moved],
        [square(q) * (1 + STEP**2 * square(omega) / 4), *(left_product(q) * turn)],
    )
    yield identity(
        r"For the rotations, $\hat R(q + \tfrac h2L(q)\omega) = \hat R(q)\,\hat R(1, \tfrac "
        r"h2\omega)$: the body turns by the rotation of $(1, \tfrac h2\omega)$, Cayley's, and "
        r"stays on $\mathrm{SO}(3)$.",
        rotation(moved),
        rotation(q) * rotation(turn),
    )
    v, spin = kick(STATE, BODY)
    turned, n = drift(q, spin), scalar("n")
    yield identity(
        r"The step from which the code is generated is the kick and then the drift with the new "
        r"velocities: $c' = c + hv'$, $q'$ the drift over its length (here times the symbol $n$).",
        inverted(splitting_step(STATE, BODY), {sympy.sqrt(square(turned)): n}),
        Matrix([*(STATE.c + STEP * v), *(n * turned), *v, *spin]),
    )


def _consistent(kicked: Kick, drifted: Drift) -> Proof:
    E, h = scalar("E"), STEP
    small = {DECAY: 1 - DAMPING * h + DAMPING * h**2 * E, IMPULSE: h - h**2 * E}
    old, rates = Matrix([*STATE.v, *STATE.omega]), Matrix.vstack(*accelerations(STATE, BODY))
    force = rates + DAMPING * old
    yield identity(
        r"Write $e = 1 - \mu h + \mu h^2 E$ and so $i = h - h^2E$, $\mu i + e = 1$. By Taylor, "
        r"$1 - x \le e^{-x} \le 1 - x + \tfrac12x^2$ for $x \ge 0$, so $0 \le E \le \tfrac12\mu$. "
        r"The new velocities are $z' = z + h\dot z + h^2E\,(\mu z - f)$, with the shipped "
        r"accelerations $\dot z$ and $f = \dot z + \mu z$: consistent of order one.",
        [
            DAMPING * small[IMPULSE] + small[DECAY],
            Matrix.vstack(*kicked(STATE, BODY)).subs(small),
        ],
        [1, old + h * rates + h**2 * E * (DAMPING * old - force)],
    )
    z = vector("z")
    moved = drifted(STATE.q, STATE.omega + h * z)
    yield identity(
        r"With $v' = v + hy$ and $\omega' = \omega + hz$ the pose moves by $c' = c + hv + h^2y$ "
        r"and $q + h\,\tfrac12L(q)\,\omega + \tfrac{h^2}2L(q)\,z$: order one again.",
        moved,
        STATE.q + h * body(STATE.q) * STATE.omega / 2 + h**2 * body(STATE.q) * z / 2,
    )
    n = scalar("n")
    yield modulo(
        r"And the length $n$ that is divided by, $n^2 = 1 + \tfrac{h^2}4|\omega'|^2$ for $|q| = 1$,"
        r" is one up to second order: $(n - 1)(n + 1) = \tfrac{h^2}4|\omega'|^2$, so $0 \le n - 1 "
        r"\le \tfrac{h^2}8|\omega'|^2$. The whole step is $s + h\,\mathcal F(s)$ up to terms with "
        r"$h^2$.",
        (n - 1) * (n + 1),
        square(drifted(STATE.q, STATE.omega)) - 1,
        [UNIT, LENGTH],
    )


def _rests(kicked: Kick, drifted: Drift) -> Proof:
    q, omega, u = STATE.q, STATE.omega, vector("u")
    moved = drifted(q, omega)
    yield identity(
        r"Where does a step change nothing? $c' = c + hv'$ gives $v' = 0$. The part of the drift "
        r"across $q$ has the squared length $|q|^2|q + \tfrac h2L\omega'|^2 - \bigl(q\cdot(q + "
        r"\tfrac h2L\omega')\bigr)^2 = \tfrac{h^2}4|q|^4|\omega'|^2$, so the rotation is kept "
        r"only if $\omega' = 0$. And as nothing changes, $v = v' = 0$ and $\omega = \omega' = 0$.",
        square(q) * square(moved) - inner(q, moved) ** 2,
        STEP**2 / 4 * square(q) ** 2 * square(omega),
    )
    v, spin = kicked(AT_REST, BODY)
    torque = quaternion_torque(q, BODY)
    yield identity(
        r"From rest the kick gives $v' = -2ic$ and $\omega' = i\,J^{-1}\tau$.",
        [*v, *spin],
        [*(-2 * IMPULSE * STATE.c), *(IMPULSE * BODY.inertia_inverse * torque)],
    )
    yield positive(
        r"With $i > 0$ the first is zero for $c = 0$ only: $|v'|^2 = 4 i^2 |c|^2$. In the same way "
        r"the second is for $J^{-1}\tau = 0$ only.",
        square(v),
        [[4, Square(PUSHED[0]), Square(entry)] for entry in APART.parts],
    )
    yield combination(
        r"That is $\tau = 0$: for every $u$, $u\cdot\tau - (Ju)\cdot J^{-1}\tau$ is a combination "
        r"of the entries of $JJ^{-1} - I$. So the states that a step does not change are exactly "
        r"the equilibria at rest, for every $h > 0$.",
        inner(u, torque) - inner(BODY.inertia * u, BODY.inertia_inverse * torque),
        contraction(-u * torque.T, INERTIA_INVERSE),
    )


def _translation(kicked: Kick) -> Proof:
    x, h, e, i = scalar("x"), STEP, DECAY, IMPULSE
    v, rates = kicked(STATE, BODY)[0], accelerations(STATE, BODY)[0]
    ends = Matrix([*(STATE.c + h * v), *v])
    steps = [jacobian([ends[k], ends[k + 3]], [STATE.c[k], STATE.v[k]]) for k in range(3)]
    yield identity(
        r"The translation is linear, the same in each axis: $(c, v) \mapsto A\,(c, v)$ with $A = "
        r"\begin{pmatrix}1 - 2hi & he\\ -2i & e\end{pmatrix}$ and $\det A = e = e^{-\mu h}$. The "
        r"area of the plane of $(c, v)$ shrinks by the same factor as under the flow, whose "
        r"divergence there is $-\mu$: the scheme is conformal.",
        [
            [*A, A.det(), slope.diff(speed)]
            for A, slope, speed in zip(steps, rates, STATE.v, strict=True)
        ],
        [[1 - 2 * h * i, h * e, -2 * i, e, e, -DAMPING]] * 3,
    )
    A = steps[0]
    polynomial = (x * sympy.eye(2) - A).det()
    yield identity(
        r"Its characteristic polynomial $\chi$ has $\chi(1) = 2hi > 0$ and $\chi(-1) = 2(1 + e - "
        r"hi)$. If $hi < 1 + e$ both are positive, so real eigenvalues lie in $(-1, 1)$, because "
        r"their product $e$ is below one, and others have $|x|^2 = e$: the translation settles. If "
        r"$hi > 1 + e$, one eigenvalue is below $-1$ and the motion grows: the step has a limit.",
        [polynomial.subs(x, 1), polynomial.subs(x, -1)],
        [2 * h * i, 2 * (1 + e - h * i)],
    )
    yield positive(r"Indeed $\chi(1) > 0$,", polynomial.subs(x, 1), [[2, STEPPED[0], PUSHED[0]]])
    yield positive(r"$\chi(-1) > 0$ under the condition,", polynomial.subs(x, -1), [[2, STABLE[0]]])
    yield positive(r"and $1 - e = \mu i > 0$.", DAMPING * i, [[DAMPED[0], PUSHED[0]]])
    velocity = kicked(AT_REST, BODY)[0]
    moved = STATE.c + h * velocity
    yield identity(
        r"Nor does the energy fall in every step: from rest, $|c|^2 + \tfrac12|v|^2$ changes by "
        r"$2i\,\bigl((1 + 2h^2)\,i - 2h\bigr)|c|^2$. For $h = 1$, $\mu = \tfrac12$, where $i \ge h "
        r"- \tfrac12\mu h^2 = \tfrac34$, that is a rise.",
        [square(moved) + square(velocity) / 2 - square(STATE.c), 3 * Rational(3, 4) - 2],
        [2 * i * ((1 + 2 * h**2) * i - 2 * h) * square(STATE.c), Rational(1, 4)],
    )


def _force_of_m(state: QuaternionState, constants: Body) -> tuple[Array, Array]:
    v, omega = kick(state, constants)
    return v + IMPULSE * state.c, omega


def _drag_forgotten(state: QuaternionState, constants: Body) -> tuple[Array, Array]:
    v, omega = kick(state, constants)
    return v, omega + (1 - DECAY) * state.omega


CLAIM = Claim(
    name="splitting",
    title="The conformal splitting",
    statement=r"The splitting, a kick with exact damping and then a drift along Cayley's rotation, "
    r"keeps $|q| = 1$ and is consistent of order one with the equations of motion. For every $h > "
    r"0$ the states that it does not change are exactly the equilibria at rest. Its translation "
    r"shrinks areas in each plane of $(c, v)$ by exactly $e^{-\mu h}$, as the flow does, and is "
    r"stable for $hi < 1 + e$, where $e = e^{-\mu h}$, $i = (1 - e)/\mu$.",
    concludes=(1, 3, 4, 5, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19),
    hypotheses=(
        DAMPED,
        STEPPED,
        INERTIA_INVERSE,
        UNIT,
        PUSHED,
        DECAYING,
        LENGTH,
        APART,
        STABLE,
    ),
    source="ours",
    proof=proof,
    witness={DAMPING: 1, STEP: 1, IMPULSE: Fraction(1, 2), DECAY: Fraction(1, 2)}
    | dict.fromkeys((quaternion()[0], scalar("n"), STATE.c[0]), 1)
    | dict.fromkeys((entry(name, k, k) for name in "IJ" for k in (1, 2, 3)), 1),
    controls={
        "springs of stiffness m in the force": Mutation(
            at=1, proof=lambda: proof(kicked=_force_of_m)
        ),
        "a spin without drag": Mutation(at=1, proof=lambda: proof(kicked=_drag_forgotten)),
        "a drift by the whole step": Mutation(
            at=3, proof=lambda: proof(drifted=lambda q, omega: drift(q, omega, 2 * STEP))
        ),
    },
    not_claimed="That the energy falls in every step, which is false, or that the scheme is stable "
    "for every step, which is false, too. For the rotation nothing is said about stability: the "
    "kick treats the gyroscopic torque explicitly, and with weak damping and large steps a run can "
    "diverge. The stopping rule, not the integrator, decides where a run has ended.",
    needs=("quaternions", "torque", "euler_poincare"),
    runs=(
        "derivations.integrators.splitting_step",
        "derivations.integrators.accelerations",
        "derivations.integrators.squared_speed",
    ),
    used_by=("certreg.dynamics.simulation.simulate",),
    not_in_coq="Nothing in Coq speaks of integrators.",
)
