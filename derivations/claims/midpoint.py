"""Claim: the implicit midpoint rule obeys the energy law of the flow exactly, at any step size."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from .. import integrators
from ..algebra import Square, combination, contraction, identity, nonnegative
from ..hypotheses import INERTIA_INVERSE, UNDRIVEN, inverted
from ..hypothesis import Standing, invertible, nonnegative_by, vanishing
from ..integrators import STEP, QuaternionState
from ..kernel import Claim, Mutation, Proof
from ..moments import inertia_of
from ..motion import DAMPING, Body, State, kinetic, potential
from ..notation import (
    Array,
    Matrix,
    body,
    inner,
    matrix,
    quaternion,
    rotation,
    scalar,
    square,
    vector,
)
from .splitting import quaternion_equations

STRETCH_INVERSE, E_INVERSE = scalar("u"), scalar("e")
E = 1 + STEP * DAMPING / 2 + STEP**2 / 2

Q, OMEGA, BODY = quaternion(), vector("omega"), Body()
QM, WM = quaternion("p"), vector("w")  # the middle quaternion and angular velocity
NOTATION = Standing.NOTATION
STRETCH = invertible(
    "$u = 1/D$.", integrators.middle_stretch(WM), STRETCH_INVERSE, standing=NOTATION
)
SLOWED = invertible("$e = 1/E$.", E, E_INVERSE, standing=NOTATION)
AT_ROOT = vanishing(
    r"$\omega_m$ is a root of the three equations: the balance is zero.",
    integrators.angular_balance(QM, OMEGA, BODY, WM, STEP),
    standing=Standing.CASE,
    solves=tuple(OMEGA),
)
FORWARD = nonnegative_by(r"$h \ge 0$.", STEP)


@dataclass(frozen=True)
class Rule:
    """The functions that make up a step."""

    direction: Callable[[Any, Any], Array] = integrators.middle_direction
    stretch: Callable[[Any], Any] = integrators.middle_stretch
    balance: Callable[[Any, Any, Body, Any, Any], Array] = integrators.angular_balance
    step: Callable[[QuaternionState, Any], Array] = integrators.midpoint_step


def proof(rule: Rule | None = None) -> Proof:
    """The middle quaternion; the step; that it is the midpoint rule; its energy; where it ends."""
    rule = rule or Rule()
    yield from _middle_quaternion(rule)
    yield from _step(rule)
    yield from _is_the_midpoint_rule(rule)
    yield from _translation_energy()
    yield from _rotation_energy(rule)
    yield _loss()
    yield from _comes_to_rest(rule)


def _middle_quaternion(rule: Rule) -> Proof:
    N, D, b = rule.direction(Q, WM), rule.stretch(WM), quaternion("b")
    yield identity(
        r"Let $\omega_m$ be any vector, $D = 1 + \tfrac{h^2}{16}|\omega_m|^2$ and $N = q + "
        r"\tfrac h4 L(q)\,\omega_m$. Then $N = D\,q + \tfrac h4 L(N)\,\omega_m$: what is quadratic "
        r"in $\omega_m$ on the right is taken up by $D$.",
        N,
        D * Q + STEP / 4 * body(N) * WM,
    )
    yield nonnegative(
        r"$D - 1 = \sum_k \bigl(\tfrac h4\omega_{m,k}\bigr)^2 \ge 0$, so one can divide by $D$.",
        D - 1,
        [[Square(STEP * speed / 4)] for speed in WM],
    )
    shipped = inverted(integrators.middle_quaternion(Q, WM), {D: STRETCH_INVERSE})
    yield combination(
        r"The middle quaternion in the code is $q_m = u N$, $u$ standing for $\tfrac1D$. It solves "
        r"its equation $q_m = q + \tfrac h4 L(q_m)\,\omega_m$: for every $b$, the difference of "
        r"the sides is $(b\cdot q)(uD - 1)$.",
        inner(b, shipped - Q - STEP / 4 * body(shipped) * WM),
        [(inner(b, Q), STRETCH[0])],
    )
    yield identity(
        r"The quaternion after the step, $2q_m - q$, is as long as $q$: $|2N - Dq|^2 = D^2|q|^2$. "
        r"The middle is shorter, $|N|^2 = D|q|^2$, so $|q_m|^2 = |q|^2/D$, and it must not be "
        r"normalised.",
        [square(2 * N - D * Q), square(N)],
        [D**2 * square(Q), D * square(Q)],
    )


def _step(rule: Rule) -> Proof:
    state = QuaternionState()
    N, D = rule.direction(state.q, WM), rule.stretch(WM)
    inverses = {D: STRETCH_INVERSE, E: E_INVERSE}
    middle_v = E_INVERSE * (state.v - STEP * state.c)
    yield identity(
        r"The step in the code, given $\omega_m$: with $v_m = \tfrac1E(v - hc)$, $E = 1 + "
        r"\tfrac{h\mu}2 + \tfrac{h^2}2$, it ends at $c' = c + hv_m$, $q' = 2q_m - q$, $v' = 2v_m - "
        r"v$, $\omega' = 2\omega_m - \omega$. So $q_m$, $v_m$, $\omega_m$ and $c_m = c + \tfrac "
        r"h2v_m$ are the means of the values before and after.",
        inverted(rule.step(state, WM), inverses),
        Matrix.vstack(
            state.c + STEP * middle_v,
            2 * STRETCH_INVERSE * N - state.q,
            2 * middle_v - state.v,
            2 * WM - state.omega,
        ),
    )
    b = vector("b")
    yield combination(
        r"That $v_m$ is the one with $v = E\,v_m + hc$: for every $b$, the difference is "
        r"$-b\cdot(v - hc)\,(eE - 1)$ with $e$ standing for $\tfrac1E$. All terms of $E$ are "
        r"positive, so the division is harmless for every $h > 0$.",
        inner(b, state.v - E * middle_v - STEP * state.c),
        [(-inner(b, state.v - STEP * state.c), SLOWED[0])],
    )


def _is_the_midpoint_rule(rule: Rule) -> Proof:
    c, middle_v = vector("c"), vector("y")
    middle = QuaternionState(c=c + STEP / 2 * middle_v, q=QM, v=middle_v, omega=WM)
    linear, angular = integrators.accelerations(middle, BODY)
    yield identity(
        r"The translation is the midpoint rule: with $v = Ev_m + hc$, $v_m - v = \tfrac h2\,(-2c_m "
        r"- \mu v_m)$, the shipped acceleration at $c_m$, $v_m$. Together with $c' - c = hv_m$ and "
        r"$v' - v = 2(v_m - v)$: $s' - s = h\,\mathcal F(s_m)$.",
        middle_v - (E * middle_v + STEP * c),
        STEP / 2 * linear,
    )
    yield from _turning(rule, angular)
    yield quaternion_equations()


def _turning(rule: Rule, angular: Array) -> Proof:
    b = vector("b")
    undamped = integrators.quaternion_torque(QM, BODY) - WM.cross(BODY.inertia * WM)
    found = rule.balance(QM, OMEGA, BODY, WM, STEP)
    yield combination(
        r"So is the rotation. $q' - q = 2(q_m - q) = \tfrac h2L(q_m)\,\omega_m$, and the three "
        r"numbers that Newton's method brings to zero, the balance, are $J(\omega_m - \omega) - "
        r"\tfrac h2J\,\alpha(q_m, \omega_m)$ with the shipped angular acceleration $\alpha$: for "
        r"every $b$, the difference is a combination of the entries of $JJ^{-1} - I$.",
        inner(b, found - BODY.inertia * (WM - OMEGA)) + STEP / 2 * inner(BODY.inertia * b, angular),
        contraction(STEP / 2 * b * undamped.T, INERTIA_INVERSE),
    )
    inverses = {rule.stretch(WM): STRETCH_INVERSE}
    yield identity(
        r"The residual from which the code is generated is this balance with the solved $q_m$ put "
        r"in: three equations for the three unknowns $\omega_m$.",
        inverted(integrators.midpoint_residual(QuaternionState(), BODY, WM), inverses),
        rule.balance(
            inverted(integrators.middle_quaternion(Q, WM), inverses), OMEGA, BODY, WM, STEP
        ),
    )


def _translation_energy() -> Proof:
    c, middle_v = vector("c"), vector("y")
    v = E * middle_v + STEP * c
    before, after = State(c=c, v=v), State(c=c + STEP * middle_v, v=2 * middle_v - v)
    stored = potential(after, BODY) - potential(before, BODY)
    yield identity(
        r"The energy of the translation: with $v = Ev_m + hc$, $c' = c + hv_m$, $v' = 2v_m - v$, "
        r"$\;\Delta\bigl(|c|^2 + \tfrac12|v|^2\bigr) = -h\mu\,|v_m|^2$.",
        stored + kinetic(after, BODY)[0] - kinetic(before, BODY)[0],
        -STEP * DAMPING * square(middle_v),
    )


def _rotation_energy(rule: Rule) -> Proof:
    turn, J = STEP / 4 * body(QM) * WM, BODY.inertia
    torque = integrators.quaternion_torque(QM, BODY)
    before = State(R=rotation(QM - turn), omega=OMEGA)
    after = State(R=rotation(QM + turn), omega=2 * WM - OMEGA)
    work = potential(after, BODY) - potential(before, BODY)
    spin = kinetic(after, BODY)[1] - kinetic(before, BODY)[1]
    yield identity(
        r"The rotation. Both energies are quadratic forms ($V_p$ in $q$, for $|q| = 1$, which is "
        r"kept), and the difference of such a form is twice the bilinear form of mean and "
        r"difference. The ends are $q_m \mp \tfrac h4L(q_m)\,\omega_m$, so $\Delta(-2q^{\mathsf "
        r"T}Kq) = -h\,\omega_m\cdot \tau(q_m)$ with the torque $\tau = 2L(q_m)^{\mathsf T}Kq_m$; "
        r"and $\Delta\bigl(\tfrac12\omega^{\mathsf T}J\omega\bigr) = 2\,\omega_m\cdot J(\omega_m - "
        r"\omega)$.",
        [work, spin],
        [-STEP * inner(WM, torque), 2 * inner(WM, J * (WM - OMEGA))],
    )
    yield identity(
        r"Added up, for every $\omega_m$, a root or not: $\;\Delta V_{rot} = -h\mu\,\omega_m^{"
        r"\mathsf T}J\omega_m + 2\,\omega_m\cdot b$ with the balance $b$. The gyroscopic term, "
        r"orthogonal to $\omega_m$, does no work. At a root $b = 0$ and the law is exact; where "
        r"Newton stops early, the last term says by how much it is missed.",
        work + spin,
        2 * inner(WM, rule.balance(QM, OMEGA, BODY, WM, STEP)) - STEP * DAMPING * inner(WM, J * WM),
    )
    yield combination(
        r"So at a root $\Delta V_{rot} = -h\mu\,\omega_m^{\mathsf T}J\omega_m$.",
        work + spin + STEP * DAMPING * inner(WM, J * WM),
        contraction(2 * WM, AT_ROOT),
    )


def _loss() -> Any:
    B, middle_v = matrix("B"), vector("y")
    factors = [FORWARD[0], UNDRIVEN[0]]
    J = inertia_of(B.T * B)
    return nonnegative(
        r"With $S_2 = B^{\mathsf T}B$, rows $b_k$, what is lost is a sum of squares: "
        r"$\;-\Delta V = h\mu\,|v_m|^2 + h\mu\sum_k|\omega_m\times b_k|^2 \ge 0$. Whatever root "
        r"is found and whatever $h > 0$, the energy never rises, neither the whole nor that of the "
        r"rotation alone. The certified basin is a set $\tfrac12\omega^{\mathsf T}J\omega - "
        r"2q^{\mathsf T}Kq < -2\lambda_2$: a run that has entered it stays in it.",
        STEP * DAMPING * (square(middle_v) + inner(WM, J * WM)),
        [
            [*factors, Square(entry)]
            for entry in (*middle_v, *(s for k in range(3) for s in WM.cross(B.row(k).T)))
        ],
    )


def _comes_to_rest(rule: Rule) -> Proof:
    delta, next_q, next_w, next_h = vector("delta"), quaternion("r"), vector("z"), scalar("k")
    J = BODY.inertia
    first = rule.balance(QM, WM - delta, BODY, WM, STEP)
    second = rule.balance(next_q, WM + delta, BODY, next_w, next_h)

    def pull(q: Array, w: Array) -> Array:
        return integrators.quaternion_torque(q, BODY) - w.cross(J * w) - DAMPING * J * w

    yield identity(
        r"A run without end comes to rest, if $J \succ 0$ and the steps stay between two positive "
        r"bounds. $V$ is bounded below, so the losses sum to a finite number, and $v_m \to 0$, "
        r"$\omega_m \to 0$. The balances of two successive steps, from $\omega_m - \delta$ to "
        r"$\omega_m + \delta$ with $h$, and on with $h'$, $q_m'$, $\omega_m'$, add up to "
        r"$J(\omega_m' - \omega_m) - \tfrac h2\tau(q_m) - \tfrac{h'}2\tau(q_m')$ and terms with a "
        r"factor $\omega_m$ or $\omega_m'$. They are zero, and $q_m' - q_m \to 0$; so "
        r"$\tau(q_m) \to 0$, and then $J\delta \to 0$ from one balance, hence $\omega \to 0$.",
        first + second,
        J * (next_w - WM) - STEP / 2 * pull(QM, WM) - next_h / 2 * pull(next_q, next_w),
    )
    c, middle_v, next_v = vector("c"), vector("y"), vector("x")
    moved, later = c + STEP * middle_v, E.subs(STEP, next_h)
    start, end = E * middle_v + STEP * c, later * next_v + next_h * moved
    yield identity(
        r"The translation in the same way: $v' = 2v_m - v$ with $v = Ev_m + hc$, and $v' = E'v_m' "
        r"+ h'c'$ with $c' = c + hv_m$, give $(h + h')\,c = (2 - E - hh')\,v_m - E'v_m'$, so "
        r"$c \to 0$ and $v \to 0$. All limits of the run are equilibria; of a run that has entered "
        r"the certified basin, the optimum only.",
        2 * middle_v - start - end,
        (2 - E - STEP * next_h) * middle_v - later * next_v - (STEP + next_h) * c,
    )


def _undamped(q: Any, omega: Any, constants: Body, middle_omega: Any, step: Any) -> Array:
    drag = step / 2 * DAMPING * constants.inertia * Matrix(middle_omega)
    return integrators.angular_balance(q, omega, constants, middle_omega, step) - drag


def _half_the_springs(q: Any, omega: Any, constants: Body, middle_omega: Any, step: Any) -> Array:
    pull = step / 4 * integrators.quaternion_torque(q, constants)
    return integrators.angular_balance(q, omega, constants, middle_omega, step) + pull


def _old_velocity(state: QuaternionState, middle_omega: Any) -> Array:
    found = integrators.midpoint_step(state, middle_omega)
    return Matrix([*(state.c + STEP * state.v), *found[3:, :]])


CLAIM = Claim(
    name="midpoint",
    title="The midpoint rule's exact energy law",
    statement=r"The step in the code is that of the implicit midpoint rule in quaternions, with "
    r"$q_m = q + \tfrac h4L(q_m)\,\omega_m$ and $s' - s = h\,\mathcal F(s_m)$. With any root "
    r"$\omega_m$ of its equations and any $h > 0$ it keeps $|q| = 1$ and changes the energy per "
    r"unit of mass by exactly $\;\Delta V = -h\mu\,\bigl(|v_m|^2 + \omega_m^{\mathsf "
    r"T}J\omega_m\bigr)$. So the energy never rises, a run that has entered the certified basin "
    r"stays in it, and if $J \succ 0$ and the steps stay between two positive bounds, every run "
    r"tends to the equilibria.",
    concludes=(1, 2, 3, 4, 5, 6, 7, 8, 11, 12, 13, 14, 15, 16, 17),
    hypotheses=(STRETCH, SLOWED, INERTIA_INVERSE, AT_ROOT, FORWARD, UNDRIVEN),
    setting=(
        (
            r"$|q| = 1$ at the start, and then always. $J$ is the inertia per unit of mass, $J = "
            r"\operatorname{tr}(S_2)\,I - S_2$ with $S_2 = B^{\mathsf T}B$."
        ),
    ),
    source="ours",
    proof=proof,
    controls={
        "a middle at the end of the step": Mutation(
            at=1,
            proof=lambda: proof(
                replace(Rule(), direction=lambda q, w: integrators.middle_direction(q, w, 2 * STEP))
            ),
        ),
        "the centre moved by the old velocity": Mutation(
            at=5, proof=lambda: proof(replace(Rule(), step=_old_velocity))
        ),
        "a balance without drag": Mutation(
            at=8, proof=lambda: proof(replace(Rule(), balance=_undamped))
        ),
        "a balance with half the springs": Mutation(
            at=8, proof=lambda: proof(replace(Rule(), balance=_half_the_springs))
        ),
    },
    not_claimed=r"That a root exists or that Newton's method finds one: where not, the code "
    r"halves the step. That every step loses energy: from $v = hc$, $\omega = -\tfrac "
    r"h2J^{-1}\tau$ one step keeps it. Nothing is said of rounding, which the code takes out of "
    r"$|q|$ after each step, nor of how far the run is from the flow.",
    needs=("quaternions", "davenport", "torque", "euler_poincare", "inertia", "properness"),
    runs=(
        "derivations.integrators.midpoint_residual",
        "derivations.integrators.midpoint_step",
    ),
    used_by=("certreg.dynamics.simulation.simulate",),
    not_in_coq="Nothing in Coq speaks of integrators.",
)
