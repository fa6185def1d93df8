"""Claim: the equations of motion on springs that are matrices; the midpoint rule's energy law."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import sympy

from certreg.dynamics.valleys import without_traces

from ..algebra import combination, contraction, identity
from ..hypotheses import INERTIA_INVERSE, ROTATION
from ..integrators import STEP, QuaternionState
from ..kernel import Claim, Mutation, Proof
from ..motion import DAMPING, State, body_kinetic_energy
from ..notation import (
    Array,
    Matrix,
    body,
    gradient,
    hat,
    inner,
    matrix,
    quaternion,
    rotation,
    symmetric,
    vector,
)
from ..spring_integrators import Middle, balance
from ..spring_motion import (
    SpringBody,
    SpringCloud,
    euler_poincare,
    kinetic_energy,
    newton_euler,
    potential,
    potential_energy,
    pull,
    rate,
    spring_force,
    torque_of,
)

Equations = Callable[[State, SpringCloud], tuple[Array, Array]]
Traceless = Callable[[Sequence[Sequence[Any]]], tuple[list[list[Any]], Any]]
Balance = Callable[..., Array]


def proof(
    equations: Equations = euler_poincare,
    traceless: Traceless = without_traces,
    balanced: Balance = balance,
) -> Proof:
    """One spring; Hamilton's principle; the sums over the points; the shipped rates; a step."""
    yield _one_spring()
    yield _kinetic()
    yield _by_parts(equations)
    yield _same_as_newton(equations)
    yield from _shipped(traceless)
    yield from _energy_of_a_step(balanced)


def _one_spring() -> Any:
    W, y, r = symmetric("W"), vector("y"), vector("r")
    return identity(
        r"One spring: $(y - r)^{\mathsf T} W (y - r) = y^{\mathsf T} W y - 2 (W y) \cdot r + "
        r"r^{\mathsf T} W r$. So energy, force and torque are linear in the sums of $W$, $W_{ab} "
        r"x$, $W_{ab} x x^{\mathsf T}$, $W y$, $W y\, x^{\mathsf T}$ and $y^{\mathsf T} W y$, 73 "
        r"numbers for any number of points.",
        ((y - r).T * W * (y - r))[0],
        (y.T * W * y)[0] - 2 * inner(W * y, r) + (r.T * W * r)[0],
    )


def _kinetic() -> Any:
    state, cloud = State(), SpringCloud()
    rigid: Any = cloud  # mass and inertia are all that is asked for
    identity_like = {entry: int(k % 4 == 0) for k, entry in enumerate(state.R)}
    return identity(
        r"With the masses $m = \operatorname{tr} W/3$ and $x$ about their mean, $\sum m\, |\dot "
        r"r|^2/2 = M |v|^2/2 + \omega^{\mathsf T} J \omega/2$, here at $R = I$: a rotation turns "
        r"$\omega \times x$ and changes no length.",
        kinetic_energy(state, cloud).subs(identity_like),
        body_kinetic_energy(state, rigid),
    )


def _by_parts(equations: Equations) -> Any:
    state, cloud = State(), SpringCloud()
    rigid: Any = cloud  # mass and inertia are all that is asked for
    a, alpha = vector("a"), vector("alpha")
    xi, dxi, phi, dphi = vector("xi"), vector("dxi"), vector("phi"), vector("dphi")
    kinetic = body_kinetic_energy(state, rigid)
    lagrangian = kinetic - potential_energy(state, cloud)
    p, spin = gradient(kinetic, state.v), gradient(kinetic, state.omega)
    varied = (
        inner(gradient(lagrangian, state.c), xi)
        + inner(gradient(lagrangian, state.v), dxi)
        + inner(gradient(lagrangian, state.R), state.R * hat(phi))
        + inner(gradient(lagrangian, state.omega), dphi + state.omega.cross(phi))
    )
    drag = -DAMPING * (inner(p, xi) + inner(spin, phi))
    dp, dspin = p.jacobian(state.v) * a, spin.jacobian(state.omega) * alpha
    boundary = inner(dp, xi) + inner(p, dxi) + inner(dspin, phi) + inner(spin, dphi)
    force, torque = equations(state, cloud)
    return identity(
        r"Hamilton's principle, as for isotropic springs: with $L = V_k - V_p$ and the work "
        r"$-\mu\, (p \cdot \xi + \pi \cdot \varphi)$ of the damping, $\delta L + \delta W = "
        r"\frac{d}{dt}(p \cdot \xi + \pi \cdot \varphi) + (f - M a) \cdot \xi + (\tau + \pi \times "
        r"\omega - J \alpha) \cdot \varphi$ in all jets. So it holds if and only if $M a = f$ and "
        r"$J \alpha = \tau - \omega \times J \omega$.",
        varied + drag,
        boundary + inner(force - cloud.mass * a, xi) + inner(torque - cloud.inertia * alpha, phi),
    )


def _same_as_newton(equations: Equations) -> Any:
    state, cloud = State(), SpringCloud()
    added = newton_euler(state, cloud)
    derived = equations(state, cloud)
    rigid = {entry: int(k % 4 == 0) for k, entry in enumerate(state.R)}
    return identity(
        r"They are what one adds up over the points, $M a = \sum 2 W e - \mu M v$ and $J \alpha + "
        r"\omega \times J \omega = \sum x \times R^{\mathsf T} 2 W e - \mu J \omega$, $e = y - R x "
        r"- c$: the springs for every matrix $R$; the drag at $R = I$, as it turns with the body.",
        [*derived[0].subs(DAMPING, 0), *derived[1].subs(DAMPING, 0)]
        + [entry.subs(rigid) for part in derived for entry in part],
        [*added[0].subs(DAMPING, 0), *added[1].subs(DAMPING, 0)]
        + [entry.subs(rigid) for part in added for entry in part],
    )


def _body_of(cloud: SpringCloud, traceless: Traceless) -> SpringBody:
    """The parameters of a body of mass 1: what the shipped code makes of the sums."""
    rest, added = traceless(cloud.scatter.tolist())
    return SpringBody(
        stiffness=cloud.stiffness,
        lever=cloud.lever,
        scatter=Matrix(rest),
        target=cloud.target,
        cross=cloud.cross,
        spread=cloud.spread + added,
        inertia=cloud.inertia,
    )


def _shipped(traceless: Traceless) -> Proof:
    state, cloud, phi = State(), SpringCloud(), vector("phi")
    constants = _body_of(cloud, traceless)
    force, torque = euler_poincare(state, cloud)
    undriven = {DAMPING: 0, **dict.fromkeys(state.omega, 0)}
    yield identity(
        r"The shipped force of the springs is that force, for every $R$.",
        spring_force(state.c, state.R, constants),
        force.subs(DAMPING, 0),
    )
    found = torque_of(pull(state.c, state.R, constants), state.R)
    springs = 3 * cloud.source_scatter
    yield combination(
        r"The shipped torque knows $\sum W_{ab} x_j x_k$ without its traces in $(a, b)$ and in "
        r"$(j, k)$, as `without_traces` makes it. That loses nothing where $R$ is a rotation: "
        r"along $\varphi$ the difference is "
        r"$\tfrac23 \langle [\varphi] T, R^{\mathsf T} R - I \rangle$ "
        r"with $T = \sum \operatorname{tr}(W) x x^{\mathsf T}$.",
        inner(phi, found - torque.subs(undriven)),
        contraction(sympy.Rational(2, 3) * hat(phi) * springs, ROTATION),
    )
    own = SpringBody()
    given, solved = rate(state, own), INERTIA_INVERSE
    turning = torque_of(pull(state.c, state.R, own), state.R)
    turning -= state.omega.cross(own.inertia * state.omega)
    yield combination(
        r"The rates in the code solve Euler's equation: along any $\varphi$, $J \dot\omega - (\tau "
        r"- \omega \times J \omega - \mu J \omega)$ is a combination of the entries of "
        r"$J J^{-1} - I$.",
        inner(phi, own.inertia * given[15:, :] - turning + DAMPING * own.inertia * state.omega),
        contraction(phi * turning.T, solved),
    )


def _energy_of_a_step(balanced: Balance) -> Proof:
    constants, before, after = SpringBody(), matrix("R"), matrix("D")
    c, d = vector("c"), vector("d")
    mean, middle_c = (before + after) / 2, (c + d) / 2
    rise = potential(State(c=d, R=after), constants) - potential(State(c=c, R=before), constants)
    pulled = pull(middle_c, mean, constants)
    force = spring_force(middle_c, mean, constants)
    yield identity(
        r"The energy per unit of mass is quadratic in $(c, R)$, so that its change is the "
        r"derivative at the means times the differences: $\Delta V_p = -f(c_m, R_m) \cdot \Delta c "
        r"- 2 \langle P(c_m, R_m), \Delta R \rangle$.",
        rise,
        _symmetric_work(constants, pulled, force, (after - before, d - c)),
    )
    q, omega = quaternion(), vector("w")
    step = STEP / 4 * body(q) * omega
    yield identity(
        r"$R$ is a quadratic form in $q$: with the ends $q_m \mp \tfrac h4 L(q_m)\, \omega_m$ of "
        r"the step, $\Delta R = h\, \hat R(q_m) [\omega_m]_\times$.",
        rotation(q + step) - rotation(q - step),
        STEP * rotation(q) * hat(omega),
    )
    yield _law(balanced)


def _symmetric_work(
    constants: SpringBody, pulled: Array, force: Array, change: tuple[Array, Array]
) -> Any:
    del constants
    turn, shift = change
    return -inner(force, shift) - 2 * inner(pulled, turn)


def _law(balanced: Balance) -> Any:
    constants, state = SpringBody(), QuaternionState()
    turn, mean, middle = matrix("D"), matrix("N"), Middle(vector("y"), vector("w"))
    found = balanced(state, constants, middle, turn, mean)
    c = state.c + STEP / 2 * middle.v
    work = -STEP * inner(spring_force(c, mean, constants), middle.v)
    work -= 2 * STEP * inner(pull(c, mean, constants), turn * hat(middle.omega))
    J = constants.inertia
    gained = 2 * inner(middle.v, middle.v - state.v)
    gained += 2 * inner(middle.omega, J * (middle.omega - state.omega))
    lost = inner(middle.v, middle.v) + inner(middle.omega, J * middle.omega)
    return identity(
        r"Added up with $\Delta(\tfrac12 |v|^2) = 2 v_m \cdot (v_m - v)$ and $\Delta(\tfrac12 "
        r"\omega^{\mathsf T} J \omega) = 2 \omega_m \cdot J (\omega_m - \omega)$: $\Delta V = -h "
        r"\mu\, (|v_m|^2 + \omega_m^{\mathsf T} J \omega_m) + 2\, (v_m, \omega_m) \cdot b$ with "
        r"the six numbers $b$ that Newton's method brings to zero. At a root the law is exact, for "
        r"every $h$.",
        work + gained,
        2 * inner(Matrix(middle.flat), found) - STEP * DAMPING * lost,
    )


def _uncoupled(scatter: Sequence[Sequence[Any]]) -> tuple[list[list[Any]], Any]:
    """Forgets the sums of W_xy x x^T."""
    rest, added = without_traces(scatter)
    return [[0 * entry if k == 1 else entry for entry in row] for k, row in enumerate(rest)], added


def _precessing_backwards(state: State, cloud: SpringCloud) -> tuple[Array, Array]:
    force, torque = euler_poincare(state, cloud)
    return force, torque + 2 * state.omega.cross(cloud.inertia * state.omega)


def _undamped(*given: Any) -> Array:
    state, constants, middle, turn, mean = given
    drag = STEP / 2 * DAMPING
    spin = constants.inertia * middle.omega
    return balance(state, constants, middle, turn, mean) - drag * Matrix([*middle.v, *spin])


CLAIM = Claim(
    name="spring_motion",
    title="The motion on springs that are matrices",
    statement=r"Let spring $i$ pull with $2 W_i e_i$, $e_i = y_i - R x_i - c$, its point have the "
    r"mass $m_i = \operatorname{tr} W_i/3$ and the damping $\mu m_i$, $\sum m_i x_i = 0$. "
    r"Hamilton's principle holds if and only if $M \dot v = \sum 2 W_i e_i - \mu M v$ and $J "
    r"\dot\omega + \omega \times J \omega = \sum x_i \times R^{\mathsf T} 2 W_i e_i - \mu J "
    r"\omega$. The shipped rates are these. A step of the shipped midpoint rule changes the energy "
    r"by exactly $-h \mu\, (|v_m|^2 + \omega_m^{\mathsf T} J \omega_m)$ per unit of mass.",
    concludes=(3, 4, 5, 6, 7, 10),
    hypotheses=(ROTATION, INERTIA_INVERSE),
    setting=("$|q| = 1$ at the start of a step.",),
    source="ours; the principle as in [Yang2020]",
    proof=proof,
    controls={
        "gyroscopic term with the other sign": Mutation(
            at=3, proof=lambda: proof(_precessing_backwards)
        ),
        "springs that forget what couples x and y": Mutation(
            at=6, proof=lambda: proof(traceless=_uncoupled)
        ),
        "a balance without drag": Mutation(at=10, proof=lambda: proof(balanced=_undamped)),
    },
    not_claimed=r"That the energy in the code is that of the points but for rotations $R$. That a "
    r"root exists, or that Newton's method finds one: where not, the code halves the step.",
    needs=("euler_poincare", "kinetic_energy", "midpoint", "splitting"),
    standard=("The fundamental lemma of the calculus of variations.",),
    runs=(
        "certreg.dynamics.valleys.without_traces",
        "derivations.spring_motion.rate",
        "derivations.spring_integrators.balance",
    ),
    used_by=("certreg.dynamics.simulation.simulate",),
    not_in_coq="Nothing in Coq speaks of general springs in motion.",
)
