"""Claim: at rest the centroids agree, and R^T C is symmetric; nowhere else."""

from __future__ import annotations

from collections.abc import Callable

import sympy

from ..algebra import combination, contraction, identity
from ..hypotheses import moments, orthogonality
from ..kernel import Claim, Proof
from ..moments import MomentCloud, PointCloud
from ..motion import Body, State, left_gradient, potential_energy, rate, unit_cloud
from ..notation import Array, Matrix, gradient, hat, inner, matrix, square, vector, vee
from .total_torque import spring_part

Rates = Callable[[State, Body], Array]
Torque = Callable[[State, MomentCloud], Array]


def proof(rates: Rates = rate, torque: Torque = spring_part) -> Proof:
    """F(s) = 0 read entry by entry; the paper's equations; critical points of the energy."""
    yield from _velocities(rates)
    yield from _accelerations(rates, torque)
    yield from _papers_equations(torque)
    yield from _critical(torque)


def _velocities(rates: Rates) -> Proof:
    state, found = State(), rates(State(), Body())
    turning = Matrix(3, 3, list(found[3:12, :]))
    yield identity(
        r"The first three entries of $F(s)$ are $v$: at an equilibrium $v = 0$.",
        found[:3, :],
        state.v,
    )
    A = matrix("A")
    yield combination(
        r"The next nine are $\dot R = R[\omega]_\times$. Where $R$ is a rotation $R^{\mathsf "
        r"T}\dot R = [\omega]_\times$: for every matrix $A$ (so for every entry), $\langle A, "
        r"R^{\mathsf T}\dot R - [\omega]_\times\rangle$ is a combination of the entries of "
        r"$R^{\mathsf T}R - I$. So if $\dot R = 0$, then $\omega = 0$.",
        inner(A, state.R.T * turning - hat(state.omega)),
        contraction(A * hat(state.omega).T, orthogonality(state.R)),
    )


def _accelerations(rates: Rates, torque: Torque) -> Proof:
    rest = State(v=sympy.zeros(3, 1), omega=sympy.zeros(3, 1))
    body, u = Body(), vector("u")
    found, cloud = rates(rest, body), unit_cloud(body)
    yield identity(
        r"At rest the acceleration of the centre of mass is $-2c$. So $c = 0$ at an equilibrium: "
        r"the centroids of the two clouds agree.",
        found[12:15, :],
        -2 * rest.c,
    )
    turned = torque(rest, cloud)
    yield identity(
        r"And the angular acceleration is $\alpha = J^{-1}\tau$ with the springs' torque $\tau = "
        r"2\operatorname{vee}(R^{\mathsf T}C - C^{\mathsf T}R)$, all per unit of mass.",
        found[15:, :],
        body.inertia_inverse * turned,
    )
    yield combination(
        r"$\alpha = 0$ if and only if $\tau = 0$: for every $u$, $u\cdot\tau - (Ju)\cdot\alpha$ "
        r"is a combination of the entries of $JJ^{-1} - I$.",
        inner(u, turned) - inner(body.inertia * u, found[15:, :]),
        contraction(-u * turned.T, body.inertia * body.inertia_inverse - sympy.eye(3)),
    )
    aligned = rest.R.T * cloud.cross
    yield identity(
        r"$\tau$ vanishes exactly if $R^{\mathsf T}C$ is symmetric: $\tfrac12|\tau|^2 = "
        r"\lVert R^{\mathsf T}C - C^{\mathsf T}R\rVert^2$. So the equilibria are the states "
        r"$(0, R, 0, 0)$ with $R^{\mathsf T}C = C^{\mathsf T}R$, and no others.",
        square(turned) / 2,
        square(aligned - aligned.T),
    )


def _papers_equations(torque: Torque) -> Proof:
    u = vector("u")
    for n in (3, 4):
        points, state = PointCloud.of_size(n), State()
        pairs = list(zip(points.sources, points.targets, strict=True))
        pulls = points.total([2 * x.cross(state.R.T * (y - state.c)) for x, y in pairs])
        yield combination(
            rf"The paper's second equation, $\sum k\,[x]_\times R^{{\mathsf T}}(y - c) = 0$, is "
            rf"$\tau = 0$ for every $c$: with $N = {n}$ points written out the two differ, along "
            r"any $u$, by a multiple of $\sum m\,x$, which vanishes.",
            inner(u, pulls - torque(state, moments(points))),
            contraction(2 * u.cross(state.R.T * state.c), points.total(points.sources)),
        )


def _critical(torque: Torque) -> Proof:
    state, cloud = State(), MomentCloud()
    energy = potential_energy(state, cloud)
    phi = vector("phi")
    yield identity(
        r"Equilibria are the critical points of the potential energy. Its gradient in $c$ is "
        r"$2Mc$.",
        gradient(energy, state.c),
        2 * cloud.mass * state.c,
    )
    slope = left_gradient(energy, state.R)
    yield combination(
        r"Its slope along $R\exp([\varphi]_\times)$ is $-\varphi\cdot\tau$ where $R$ is a "
        r"rotation. So both vanish exactly at equilibria. $V_p$ has a minimum over poses, as it "
        r"grows with $c$ and $\mathrm{SO}(3)$ is compact. A minimum is a critical point, so the "
        r"optimal registration is an equilibrium, whatever the clouds.",
        inner(phi, slope + torque(state, cloud)),
        contraction(2 * hat(phi) * cloud.source_scatter, orthogonality(state.R)),
    )


def _falling_upwards(state: State, body: Body) -> Array:
    found = rate(state, body)
    offset = Matrix([*[0] * 12, *vector("g"), 0, 0, 0])
    return found + offset


def _in_space(state: State, cloud: MomentCloud) -> Array:
    aligned = cloud.cross * state.R.T
    return 2 * vee(aligned - aligned.T)


def _other_velocity(state: State, body: Body) -> Array:
    found = rate(state, body)
    return Matrix([*found[:3, :], *(hat(state.omega) * state.R), *found[12:, :]])


CLAIM = Claim(
    name="equilibrium_equations",
    title="The equations of rest",
    statement=r"For a rotation $R$ and $J \succ 0$: $F(s) = 0$ if and only if $c = 0$, $v = 0$, "
    r"$\omega = 0$ and $R^{\mathsf T}C = C^{\mathsf T}R$. These are the critical points of $V_p$ "
    r"on $\mathbb R^3\times\mathrm{SO}(3)$; the optimal pose is one of them.",
    assumptions=(
        "$R^{\\mathsf T}R = I$.",
        "$JJ^{-1} = I$: three of the points are not collinear.",
        "Both clouds are taken about their means.",
    ),
    source="[Yang2020], the equations of the set of equilibria, and the corollary on the optimizer",
    proof=proof,
    controls={
        "a constant field of gravity": lambda: proof(_falling_upwards),
        "torque in the target's frame": lambda: proof(torque=_in_space),
        "R turned from the left": lambda: proof(_other_velocity),
    },
    not_claimed="That the optimum is the only equilibrium, or unique: it is not, see "
    "`classification`. The argument of the paper about the next time step is not needed.",
    needs=("euler_poincare", "total_torque", "potential_energy"),
    used_by=(
        "certreg.equilibrium.presentation.equilibrium_set",
        "certreg.registration.enumeration.equilibria",
    ),
    coq=(
        "equilibrium_iff_balanced",
        "an_optimum_exists_and_is_balanced",
        "first_variation",
    ),
    not_in_coq=(
        "That the critical points of $V_p$ are no others: `first_variation` is its "
        "derivative along every turn and shift."
    ),
)
