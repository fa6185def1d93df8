"""Claim: the midpoint rule of the breathing body obeys its energy law exactly, at any step size."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy

from .. import breathing_integrators as integrators
from ..algebra import Square, combination, identity, nonnegative
from ..breathing_integrators import BreathingMiddle, BreathingQuaternionState, alignment
from ..breathing_motion import own_size
from ..hypotheses import UNDRIVEN, inverted
from ..hypothesis import Standing, invertible, nonnegative_by, vanishing
from ..integrators import STEP, middle_quaternion, middle_stretch
from ..kernel import Claim, Mutation, Proof
from ..moments import inertia_of
from ..motion import DAMPING, Body
from ..notation import Array, Matrix, body, entry, inner, quaternion, scalar, square, vector

Balance = Callable[..., tuple[Array, Any]]
QM, CM, VM = quaternion("p"), vector("b"), vector("y")  # middle quaternion, place, velocity
SM, V, OMEGA, GROWTH = scalar("k"), vector("v"), vector("omega"), scalar("p")
MIDDLE, BODY = BreathingMiddle(), Body()
HALF = STEP / 2
STATE = BreathingQuaternionState(
    c=CM - HALF * VM,
    q=QM - HALF / 2 * body(QM) * MIDDLE.omega,
    scale=SM - HALF * MIDDLE.growth,
    v=V,
    omega=OMEGA,
    growth=GROWTH,
)
E, STRETCH, AFTER = 1 + HALF * DAMPING + STEP**2 / 2, middle_stretch(MIDDLE.omega), scalar("z")
INVERSES = {E: scalar("e"), STRETCH: scalar("u"), AFTER: scalar("w")}
SLOWED = vanishing(
    r"$v_m$ is the shipped one: with $e = 1 + h\mu/2 + h^2/2$, $v = e v_m + h c$.",
    V - E * VM - STEP * STATE.c,
    standing=Standing.CASE,
    solves=tuple(V),
)
BALANCE = integrators.balance(STATE, BODY, MIDDLE, QM)
AT_ROOT = vanishing(
    r"$\omega_m, \dot s_m$ are a root of the four equations.",
    Matrix([*BALANCE[0], BALANCE[1]]),
    standing=Standing.CASE,
    solves=(*BODY.cross[:, 0], BODY.cross[1, 1]),
)
FORWARD = nonnegative_by(r"$h \ge 0$.", STEP)
GOES_ON = invertible(
    r"The scale after the step is nonzero; $w$ is its inverse.",
    AFTER,
    scalar("w"),
    example={entry("middle", 1): 1, SM: 1, entry("a", 1): 1},
)


def proof(balance: Balance = integrators.balance) -> Proof:
    """The step; its energy; what is lost; the state that is kept."""
    yield _rule()
    yield _springs()
    yield from _energy(balance)
    yield _loss()
    yield _kept()


def _rule() -> Any:
    middle_q, unknown = quaternion("r"), BreathingMiddle()
    state = BreathingQuaternionState()
    scale = state.scale + STEP * unknown.growth
    middle_v = scalar("e") * (state.v - STEP * state.c)
    middle_q = inverted(middle_quaternion(state.q, unknown.omega), {STRETCH: scalar("u")})
    found = inverted(integrators.midpoint_step(state, unknown), {E: scalar("e")})
    found = inverted(found, {STRETCH: scalar("u")})
    kept = [*found[:8], *found[8:11], found[14]]
    return identity(
        r"The step in the code ends at $c + h v_m$, $2 q_m - q$, $s + h \dot s_m$, $2 v_m - v$, $2 "
        r"\dot s_m - \dot s$: the middle values are the means of those before and after, as in "
        r"claim `midpoint`.",
        kept,
        [
            *(state.c + STEP * middle_v),
            *(2 * middle_q - state.q),
            scale,
            *(2 * middle_v - state.v),
            2 * unknown.growth - state.growth,
        ],
    )


def _springs() -> Any:
    q, s = STATE.q, STATE.scale
    after_q, after_s = 2 * QM - q, 2 * SM - s
    mean = (alignment(q, BODY) + alignment(after_q, BODY)) / 2
    work = inner(MIDDLE.omega, integrators.quaternion_torque(QM, BODY))
    return identity(
        r"Let $a = q^{\mathsf T} K q$, $\bar a$ its mean before and after. $a$ is quadratic and "
        r"$q' - q = \tfrac h2 L(q_m)\omega_m$, so $a' - a = h\,\omega_m\cdot L(q_m)^{\mathsf T} K "
        r"q_m$; and $s' a' - s a = s_m (a' - a) + (s' - s)\,\bar a$.",
        after_s * alignment(after_q, BODY) - s * alignment(q, BODY),
        SM * HALF * work + STEP * MIDDLE.growth * mean,
    )


def _energy(balance: Balance) -> Proof:
    own, omega, p = own_size(BODY), MIDDLE.omega, MIDDLE.growth
    s, after_s = STATE.scale, SM + HALF * p
    spin, middle_spin = s * OMEGA, SM * omega
    after_spin = 2 * middle_spin - spin

    def kinetic(v: Any, moved: Any, growth: Any) -> Any:
        turned = (moved.T * BODY.inertia * moved)[0]
        return (square(v) + turned + own * growth**2) / 2

    def potential(c: Any, q: Any, scale: Any) -> Any:
        return square(c) + scale**2 * own - 2 * scale * alignment(q, BODY)

    before = kinetic(V, spin, GROWTH) + potential(STATE.c, STATE.q, s)
    after = kinetic(2 * VM - V, after_spin, 2 * p - GROWTH)
    after += potential(CM + HALF * VM, 2 * QM - STATE.q, after_s)
    lost = 2 * STEP * DAMPING * kinetic(VM, middle_spin, p)
    turned, breathed = balance(STATE, BODY, MIDDLE, QM)
    left = 2 * inner(middle_spin, turned) + 2 * p * breathed
    pushed = V - VM + HALF * (-2 * CM - DAMPING * VM)
    yield identity(
        r"With the spin $\ell = s\omega$ the kinetic energy (over $M$) is $\tfrac12(|v|^2 + "
        r"\ell^{\mathsf T} J\ell + S_{xx}\dot s^2)$, quadratic. What passes from the rotation to "
        r"the scale, $\dot s_m\,\omega_m^{\mathsf T} J\ell_m$, comes once with either sign. So "
        r"$V' - V + h\mu\,(|v_m|^2 + \ell_m^{\mathsf T} J\ell_m + S_{xx}\dot s_m^2)$ is twice "
        r"$\ell_m$ and $\dot s_m$ times the four equations, and a part that vanishes with that of "
        r"the translation: the shipped equations say the law, whatever $K$, $J$, $h$ and $\mu$.",
        after - before + lost,
        left - 2 * inner(VM, pushed),
    )
    cofactors = zip([*(2 * middle_spin), 2 * p], AT_ROOT.parts, strict=True)
    yield combination(
        r"At a root, for the shipped $v_m$: $V' - V = -h\mu\,(|v_m|^2 + \ell_m^{\mathsf T} J\ell_m "
        r"+ S_{xx}\dot s_m^2)$, exactly.",
        after - before + lost,
        [*cofactors, *zip(-2 * VM, SLOWED.parts, strict=True)],
    )


def _loss() -> Any:
    spread, spin, p = vector("d"), SM * MIDDLE.omega, MIDDLE.growth
    inertia = inertia_of(sympy.diag(*(e**2 for e in spread)))
    lost = square(VM) + (spin.T * inertia * spin)[0] + inertia.trace() / 2 * p**2
    turns = [spread[j] * spin[i] for i in range(3) for j in range(3) if i != j]
    return nonnegative(
        r"That is a loss, in principal axes $h\mu$ times a sum of squares ($d_k^2$ the eigenvalues "
        r"of $S_2$): the energy never rises.",
        STEP * DAMPING * lost,
        [[FORWARD[0], UNDRIVEN[0], Square(e)] for e in (*VM, *turns, *(p * d for d in spread))],
    )


def _kept() -> Any:
    state, unknown, a = BreathingQuaternionState(), BreathingMiddle(), vector("a")
    middle_scale = state.scale + HALF * unknown.growth
    spin = 2 * middle_scale * unknown.omega - state.scale * state.omega
    shipped = spin * scalar("w")
    return combination(
        r"The angular velocity that is kept after the step is $\omega' = \ell'/s'$ with $\ell' = 2 "
        r"\ell_m - \ell$.",
        inner(a, AFTER * shipped - spin),
        [(inner(a, spin), GOES_ON[0])],
    )


def _own_alignment(*arguments: Any) -> tuple[Array, Any]:
    """The scale driven by the middle quaternion's alignment, not by the mean of both ends."""
    state, given, _, middle_q, *_ = arguments
    turned, breathed = integrators.balance(*arguments)
    after = 2 * Matrix(middle_q) - Matrix(state.q)
    mean = (alignment(state.q, given) + alignment(after, given)) / 2
    return turned, breathed + STEP * (mean - alignment(middle_q, given))


def _uncoupled(*arguments: Any) -> tuple[Array, Any]:
    """No centrifugal force on the scale."""
    state, given, middle, *_ = arguments
    turned, breathed = integrators.balance(*arguments)
    scale = state.scale + HALF * middle.growth
    return turned, breathed + HALF * scale * inner(middle.omega, given.inertia * middle.omega)


CLAIM = Claim(
    name="breathing_midpoint",
    title="A midpoint rule for the body that breathes, with its energy law",
    statement=r"At a root of the four equations of the shipped rule, of any step size $h$ and with "
    r"scales $s$, $s'$ that are not $0$, the energy changes by exactly $-h\mu\,(M|v_m|^2 + "
    r"\ell_m^{\mathsf T} J\ell_m + S_{xx}\dot s_m^2)$, $\ell_m = s_m\omega_m$: it never rises.",
    concludes=(1, 2, 3, 4, 5, 6),
    hypotheses=(SLOWED, AT_ROOT, FORWARD, UNDRIVEN, GOES_ON),
    setting=(
        r"All over the mass; $k$ is the middle scale $s_m$, $z$ the scale after the step.",
        r"$c$, $q$, $s$ before the step are the middle values less half of the step.",
    ),
    source="ours; a discrete gradient, as in claim `midpoint`",
    proof=proof,
    controls={
        "the alignment of the middle quaternion": Mutation(
            at=3, proof=lambda: proof(_own_alignment)
        ),
        "no centrifugal force": Mutation(at=3, proof=lambda: proof(_uncoupled)),
    },
    not_claimed=r"That the equations have a root, or one with $s' > 0$: the step is halved where "
    r"Newton's method finds none. In doubles a root is found but for rounding.",
    needs=("breathing_motion", "midpoint", "davenport"),
    runs=(
        "derivations.breathing_integrators.balance",
        "derivations.breathing_integrators.midpoint_step",
    ),
    used_by=("certreg.native.runs.BreathingRun",),
    not_in_coq="All of it.",
)
