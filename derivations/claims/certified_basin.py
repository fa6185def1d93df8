"""Claim: one exact inequality on a state proves that the flow from it ends at the optimum."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import sympy

from certreg.geometry.so3 import body_frame, davenport_matrix

from ..algebra import Square, combination, identity, nonnegative, positive, quoted
from ..hypotheses import DAMPED, PRINCIPAL, SOLID, SPECTRAL, definite, semidefinite
from ..hypothesis import (
    Hypothesis,
    Standing,
    nonnegative_by,
    nonzero,
    positive_by,
    vanishing,
)
from ..kernel import Claim, Mutation, Proof, Step
from ..moments import MomentCloud, inertia_of
from ..motion import DAMPING, State, newton_euler, spring_torque
from ..notation import (
    Array,
    Matrix,
    diagonal,
    entry,
    hat,
    inner,
    matrix,
    quaternion,
    scalar,
    square,
    symmetric,
    vector,
)
from ..shipped import NORM_INVERSE, TWO_POWER, checked_alignment
from .convergence import TURNING

Torque = Callable[[State, MomentCloud], Array]
QUARTER = sympy.Rational(1, 4)  # E = omega^T J omega / 2 - 2 q^T K q is minus twice the left side


P, OMEGA, J = quaternion("p"), vector("omega"), symmetric("J")
K = Matrix(davenport_matrix(matrix("C").tolist()))
FIRST, SECOND = entry("l", 1), entry("l", 2)
VALUE, SPIN = (P.T * K * P)[0], (OMEGA.T * J * OMEGA)[0]
ONE = Matrix.eye(4)


def below_by(spin: Any) -> Hypothesis:
    """The inequality on the state, with that share of the kinetic energy."""
    return positive_by(
        r"The inequality on the state.",
        VALUE - square(P) * spin * SPIN - SECOND * square(P),
        standing=Standing.CASE,
    )


TOP = nonnegative_by(
    r"$\lambda_1$ is the largest eigenvalue of $K$.",
    FIRST * square(P) - VALUE,
    prepare=lambda point: {FIRST: abs(point[FIRST]) + 100},
    further=lambda point: semidefinite(FIRST * ONE - K, point),
)
KINETIC = positive_by(
    SOLID,
    SPIN,
    further=lambda point: definite(J, point),
    example={P[0]: 1, OMEGA[0]: 1},
)
PROPER = nonzero(
    r"$p \ne 0$.",
    P,
    standing=Standing.CASE,
    example={OMEGA[0]: 1} | {J[k, k]: 1 for k in range(3)},
)
BELOW = below_by(QUARTER)
LEVELS = [entry("l", k) for k in (1, 2, 3, 4)]
ORDERED = nonnegative_by(
    r"$\lambda_1 \ge \lambda_2 \ge \lambda_3 \ge \lambda_4$ are the eigenvalues of $K$.",
    [a - b for a, b in pairwise(LEVELS)],
    standing=Standing.CASE,
    example={LEVELS[1]: 1, quaternion()[1]: 1},
)
NORM_LEFT = vanishing(
    r"The letter for $1/|p|^2$: $|p|^2 \cdot |p|^{-2} = 1$.",
    square(P) * NORM_INVERSE - 1,
    standing=Standing.CASE,
    solves=(NORM_INVERSE,),
)


def _certificate_form() -> tuple[Any, Any]:
    """|q|^2 A in an eigenbasis of K, and the vector p across q."""
    q = quaternion()
    level, eta = scalar("level"), scalar("eta")
    return square(q) * (level * ONE - sympy.diag(*LEVELS)) + eta * q * q.T, Matrix(
        [q[1], -q[0], 0, 0]
    )


CERTIFICATE, CROSSING = _certificate_form()
CERTIFIED = positive_by(
    r"The certificate is proved, $A \succ 0$.",
    (CROSSING.T * CERTIFICATE * CROSSING)[0],
    standing=Standing.CASE,
    further=lambda point: definite(CERTIFICATE, point),
    concerns=tuple(LEVELS),
)


def derived_torque(state: State, cloud: MomentCloud) -> Array:
    """J alpha: the paper's total torque less omega x J omega."""
    return newton_euler(state, cloud)[1]


def proof(
    torque: Torque = derived_torque,
    spin: Any = QUARTER,
    shipped: Callable[..., Any] = checked_alignment,
) -> Proof:
    """The energy of rotation falls; below every spurious equilibrium only the optimum is left."""
    yield from _descent(torque)
    yield from _levels(spin)
    yield from _certificate()
    yield from _distance()
    yield _decided(spin, shipped)


def _descent(torque: Torque) -> Proof:
    state, cloud = State(), MomentCloud()
    total, omega = torque(state, cloud), state.omega
    at_rest_of_translation = dict.fromkeys((*state.c, *state.v), 0)
    yield identity(
        r"The equation of rotation, $J \dot\omega = \tau - \omega \times J \omega$ with the total "
        r"torque $\tau$, does not contain $c$ and $v$: the rotation moves on its own, whatever the "
        r"translation does.",
        total,
        total.subs(at_rest_of_translation),
    )
    rotating = state.R * hat(omega)
    yield identity(
        r"Let $E = \tfrac12 \omega^{\mathsf T} J \omega - 2 \operatorname{tr}(R^{\mathsf T} C)$, "
        r"the energy of rotation but for a constant. Along $\dot R = R [\omega]_\times$ its rate "
        r"is $\omega^{\mathsf T} J \dot\omega - 2 \operatorname{tr}(\dot R^{\mathsf T} C)$, and "
        r"that is $-\mu\, \omega^{\mathsf T} J \omega$. With $J \succ 0$ and $\mu > 0$ it is never "
        r"positive, and zero at $\omega = 0$ only.",
        (omega.T * total)[0] - 2 * inner(rotating, cloud.cross),
        -DAMPING * (omega.T * cloud.inertia * omega)[0],
    )
    principal = inertia_of(diagonal("d"))
    yield positive(
        r"In principal axes that loss is $\mu \sum_k j_k \omega_k^2$, positive where the body "
        r"turns.",
        DAMPING * (omega.T * principal * omega)[0],
        [[DAMPED[0], PRINCIPAL[k], Square(TURNING[k])] for k in range(3)],
    )
    yield identity(
        r"Where $\omega$ stays zero, $J \dot\omega = 0$, which is the spring torque: such motions "
        r"are the equilibria of the rotation.",
        total.subs(dict.fromkeys(omega, 0)),
        spring_torque(state, cloud),
    )


def _levels(spin: Any) -> Proof:
    p = P
    energy = square(p) * SPIN / 2 - 2 * VALUE  # |p|^2 E
    given = BELOW if spin == QUARTER else below_by(spin)
    yield positive(
        r"With $R = R(p)$, $\operatorname{tr}(R^{\mathsf T} C) = p^{\mathsf T} K p / |p|^2 \le "
        r"\lambda_1$, so that $\tfrac12 \omega^{\mathsf T} J \omega \le E + 2 \lambda_1$ (here "
        r"times $|p|^2$). The set of states with $E \le E_0$ is closed, $\omega$ is bounded on it "
        r"as $J \succ 0$, and rotations are a compact set: it is compact. While the body turns, $E "
        r"> -2\lambda_1$.",
        energy + 2 * FIRST * square(p),
        [
            (2, TOP[0]),
            *((sympy.Rational(1, 2), Square(entry), KINETIC[0]) for entry in PROPER.parts),
        ],
    )
    yield positive(
        r"An equilibrium is an eigenvector of $K$, and one that is not optimal has an eigenvalue "
        r"of at most $\lambda_2$, hence $E \ge -2 \lambda_2$. If $p^{\mathsf T} K p / |p|^2 - "
        r"\tfrac14 \omega^{\mathsf T} J \omega > \lambda_2$, then $-2\lambda_2 - E$, here times "
        r"$|p|^2$, is twice that difference and positive: the state lies below every spurious "
        r"equilibrium.",
        -2 * SECOND * square(p) - energy,
        [(2, given[0])],
    )
    yield quoted(
        r"$E$ is continuously differentiable and does not rise, the sublevel set is compact and "
        r"invariant. By LaSalle's invariance principle the motion tends to the largest invariant "
        r"set on which $\dot E = 0$, which is the set of equilibria of the rotation in the "
        r"sublevel set. Below $-2\lambda_2$ the only one is the optimum, $\lambda_1 > \lambda_2$ "
        r"being simple, so the motion converges to it. The translation obeys "
        r"$\ddot c + \mu \dot c + 2 c = 0$ and converges by itself.",
        theorem="LaSalle's principle",
        source="[LaSalle1960]",
    )
    yield _barrier()


def _barrier() -> Step:
    d = diagonal("d")
    spectrum = [d.trace(), *(2 * d[k, k] - d.trace() for k in range(3))]
    return identity(
        r"How high the barrier is: with $d_1 \ge d_2 \ge |d_3|$ the special singular values of $C$ "
        r"and $C$ diagonal, $K$ is diagonal with $\lambda_1 = d_1 + d_2 + d_3$ and $\lambda_2 = "
        r"d_1 - d_2 - d_3$. So between the optimum at $E = -2\lambda_1$ and the lowest spurious "
        r"equilibrium lies an energy of $2(\lambda_1 - \lambda_2) = 4 (d_2 + d_3)$.",
        [Matrix(davenport_matrix(d.tolist())), 2 * (spectrum[0] - spectrum[1])],
        [sympy.diag(*spectrum), 4 * (d[1, 1] + d[2, 2])],
    )


def _certificate() -> Proof:
    q, level = quaternion(), scalar("level")
    reached = (CROSSING.T * sympy.diag(*LEVELS) * CROSSING)[0]
    yield nonnegative(
        r"**From the certificate.** Let $A = \ell I - K + \eta\, q q^{\mathsf T}/|q|^2 \succ 0$ "
        r"with $\ell = v(q) + \delta - \eta$, where $\eta$ is the number that the certificate "
        r"calls $\mu$, not the damping, and $v(q) = q^{\mathsf T} K q/|q|^2$. In an eigenbasis of "
        r"$K$ take $p = (q_2, -q_1, 0, 0)$, in the span of the first two eigenvectors and "
        r"orthogonal to $q$ (or the first eigenvector, if $q_1 = q_2 = 0$). Then $p^{\mathsf T} K "
        r"p - \lambda_2 |p|^2 = (\lambda_1 - \lambda_2)\, q_2^2 \ge 0$.",
        reached - LEVELS[1] * square(CROSSING),
        [(ORDERED[0], Square(q[1]))],
    )
    yield positive(
        r"As $q \cdot p = 0$ for this $p$, $|q|^2 (\ell |p|^2 - p^{\mathsf T} K p) = p^{\mathsf T} "
        r"(|q|^2 A)\, p > 0$. Together $\ell > \lambda_2$: the certificate's level bounds the "
        r"second eigenvalue, and $p^{\mathsf T} K p/|p|^2 - \tfrac14 \omega^{\mathsf T} J \omega > "
        r"\ell$ is enough. It is one inequality between exact numbers.",
        square(q) * (level * square(CROSSING) - reached),
        [[CERTIFIED[0]]],
    )


def _distance() -> Proof:
    p, values = P, LEVELS
    lost = values[0] * square(p) - sum(l * c**2 for l, c in zip(values, p, strict=True))
    off = Matrix(body_frame((1, 0, 0, 0))).T * p
    yield nonnegative(
        r"**How near the optimum is.** In the eigenbasis the optimum is the first unit vector, and "
        r"$|p|^2 \sin^2(\theta/2)$ is what $p$ has across it, $p_2^2 + p_3^2 + p_4^2$. And "
        r"$\lambda_1 |p|^2 - p^{\mathsf T} K p$ less $(\lambda_1 - \lambda_2)$ times that is "
        r"$(\lambda_2 - \lambda_3)\, p_3^2 + (\lambda_2 - \lambda_4)\, p_4^2 \ge 0$. So "
        r"$\sin^2(\theta/2) \le (\lambda_1 - p^{\mathsf T} K p/|p|^2)/(\lambda_1 - \lambda_2)$.",
        lost - (values[0] - values[1]) * square(off),
        [
            (ORDERED[1], Square(p[2])),
            (ORDERED[1], Square(p[3])),
            (ORDERED[2], Square(p[3])),
        ],
    )


def _decided(spin: Any, shipped: Callable[..., Any]) -> Step:
    return combination(
        r"`certreg.verify.proves_basin`, run on polynomials, compares with the level, times "
        r"$|p|^2$, $p^{\mathsf T} K p - \tfrac14 |p|^2 \omega^{\mathsf T} J \omega$, the angular "
        r"velocity being an integer vector times a power of two; $K$, $J$ and level in one unit.",
        square(P) * shipped(K, J, P, OMEGA) - (VALUE - spin * square(P) * SPIN * TWO_POWER**2),
        [(VALUE, NORM_LEFT[0])],
    )


def _driven(state: State, cloud: MomentCloud) -> Array:
    return derived_torque(state, cloud) + 2 * DAMPING * cloud.inertia * state.omega


def _pulled_from_outside(state: State, cloud: MomentCloud) -> Array:
    return derived_torque(state, cloud) + state.c.cross(state.v)


def _half_of_the_power(K: Any, J: Any, p: Any, omega: Any) -> Any:
    return checked_alignment(K, J, p, omega).subs(TWO_POWER**2, TWO_POWER)


CLAIM = Claim(
    name="certified_basin",
    title="The certified basin",
    statement=r"Let $J \succ 0$, $\mu > 0$ and $\lambda_1 > \lambda_2$. $E = \tfrac12 "
    r"\omega^{\mathsf T} J \omega - 2\, p^{\mathsf T} K p/|p|^2$ never rises along the flow, and "
    r"from every state with $$\frac{p^{\mathsf T} K p}{|p|^2} - \frac14\, \omega^{\mathsf T} J "
    r"\omega > \lambda_2$$ the flow converges to the optimum. The level $\ell = v(q) + \delta - "
    r"\eta$ of a proved optimality certificate ($\eta$ stands for its $\mu$, which is not the "
    r"damping) exceeds $\lambda_2$ and may stand in its place. The checker decides that "
    r"inequality, and the rotation does not feel the translation. The barrier in $E$ is "
    r"$2(\lambda_1 - \lambda_2) = 4(d_2 + d_3)$, and the angle $\theta$ from the optimum has "
    r"$\sin^2(\theta/2) \le (\lambda_1 - p^{\mathsf T} K p/|p|^2) / (\lambda_1 - \lambda_2)$.",
    concludes=(1, 2, 3, 4, 5, 6, 8, 9, 10, 11, 12),
    hypotheses=(
        PRINCIPAL,
        DAMPED,
        TURNING,
        TOP,
        KINETIC,
        PROPER,
        BELOW,
        ORDERED,
        CERTIFIED,
        NORM_LEFT,
    ),
    setting=("The flow is the exact one.",),
    source="[LaSalle1960]; energy and damping as in [Koditschek1989]; torque of [Yang2020]",
    proof=proof,
    witness=dict.fromkeys((*vector("d"), *J.diagonal(), DAMPING, OMEGA[0], P[0], NORM_INVERSE), 1)
    | {quaternion()[0]: 1, scalar("level"): 1}
    | dict.fromkeys(LEVELS[1:], -1),
    controls={
        "drag that drives": Mutation(at=2, proof=lambda: proof(torque=_driven)),
        "a torque that depends on the translation": Mutation(
            at=1, proof=lambda: proof(torque=_pulled_from_outside)
        ),
        "half of the kinetic energy in the inequality": Mutation(
            at=6, proof=lambda: proof(spin=QUARTER / 2)
        ),
        "a checker that does not square the power of two": Mutation(
            at=12, proof=lambda: proof(shipped=_half_of_the_power)
        ),
    },
    not_claimed=r"That states outside of the basin do not converge to the optimum; nor that almost "
    r"every state does, which is not proved here. Nor that a "
    r"computed trajectory follows the flow; what is certified is the state at which it stands.",
    needs=(
        "davenport",
        "eigenvectors",
        "spectrum",
        "euler_poincare",
        "dissipation",
        "total_force",
        "inertia",
        "optimality_certificate",
    ),
    standard=(SPECTRAL,),
    runs=("certreg.verify.proves_basin",),
    used_by=("certreg.certificate.isotropic.proves_basin",),
    coq=(
        "no_spurious_equilibrium_in_basin",
        "spin_energy_never_rises",
        "balanced_limits_in_basin_are_optimal",
        "motion_from_basin_ends_at_the_optimum",
        "certified_second_eigenvalue",
    ),
    not_in_coq=(
        "LaSalle's theorem, that the limits of the attitude are balanced: a hypothesis of "
        "`motion_from_basin_ends_at_the_optimum`, the last. That solutions exist for all times, "
        "and that a limit exists. The barrier, and the angle in terms of the energy. Floating "
        "point: that a simulated state is near the flow."
    ),
)
