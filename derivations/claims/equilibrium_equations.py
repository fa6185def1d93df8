"""Claim: at rest the centroids agree, and R^T C is symmetric; nowhere else."""

from __future__ import annotations

from collections.abc import Callable

import sympy

from ..algebra import combination, contraction, facts, identity
from ..hypotheses import CENTRED, INERTIA_INVERSE, ROTATION, SOURCES_CENTRED, moments
from ..kernel import Claim, Mutation, Proof, Step
from ..moments import MomentCloud, PointCloud
from ..motion import DAMPING, Body, State, left_gradient, potential_energy, rate, unit_cloud
from ..notation import Array, Matrix, gradient, hat, inner, matrix, square, vector, vee
from ..rings import rational
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
        contraction(A * hat(state.omega).T, ROTATION),
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
        contraction(-u * turned.T, INERTIA_INVERSE),
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
            contraction(2 * u.cross(state.R.T * state.c), CENTRED[n, "x"]),
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
        contraction(2 * hat(phi) * cloud.source_scatter, ROTATION),
    )


def _falling_upwards(state: State, body: Body) -> Array:
    found = rate(state, body)
    offset = Matrix([*[0] * 12, *vector("g"), 0, 0, 0])
    return found + offset


def _of_the_transpose(state: State, cloud: MomentCloud) -> Array:
    aligned = state.R.T * cloud.cross.T
    return 2 * vee(aligned - aligned.T)


def _not_the_third(state: State, body: Body) -> Array:
    """R is not turned about the body's third axis."""
    found, turning = rate(state, body), hat(Matrix([*state.omega[:2, :], 0]))
    return Matrix([*found[:3, :], *(state.R * turning), *found[12:, :]])


def _spinning_at_rest() -> Step:
    half, zero = sympy.Rational(1, 2), sympy.zeros(3, 1)
    one = sympy.eye(3)
    pushed = Matrix([[0, 0, 0], [half, 0, 0], [0, 0, 0]])
    state = State(c=zero, R=one, v=zero, omega=Matrix([0, 0, 1]))
    found = _not_the_third(state, Body(cross=pushed, inertia=one, inertia_inverse=one))
    return facts(
        r"At $R = J = I$, $\mu = 1$, $C_{21} = \tfrac12$ and the other entries of $C$ zero, all "
        r"rates are zero at $c = v = 0$ and $\omega = (0, 0, 1)$, which is not zero.",
        [rational(value) for value in found.subs(DAMPING, 1)],
        [0] * 18,
    )


CLAIM = Claim(
    name="equilibrium_equations",
    title="The equations of rest",
    statement=r"At rest $\dot v = -2c$ and $\dot\omega = J^{-1}\tau$ with $\tau = "
    r"2\operatorname{vee}(R^{\mathsf T}C - C^{\mathsf T}R)$. For a rotation $R$ and $J \succ 0$: "
    r"$F(s) = 0$ if and only if $c = 0$, $v = 0$, "
    r"$\omega = 0$ and $R^{\mathsf T}C = C^{\mathsf T}R$. These are the critical points of $V_p$ "
    r"on $\mathbb R^3\times\mathrm{SO}(3)$; the optimal pose is one of them.",
    concludes=(1, 2, 3, 4, 5, 6, 7, 8, 9, 10),
    hypotheses=(ROTATION, INERTIA_INVERSE, *SOURCES_CENTRED),
    setting=("Both clouds are taken about their means.",),
    source="[Yang2020], the equations of the set of equilibria, and the corollary on the optimizer",
    proof=proof,
    controls={
        "a constant field of gravity": Mutation(at=3, proof=lambda: proof(_falling_upwards)),
        "torque of the transpose of C": Mutation(
            at=4, proof=lambda: proof(torque=_of_the_transpose)
        ),
        "R that does not feel the third angular velocity": Mutation(
            at=2, proof=lambda: proof(_not_the_third), instance=_spinning_at_rest
        ),
    },
    not_claimed="That the optimum is the only equilibrium, or unique: it is not, see "
    "`classification`. The argument of the paper about the next time step is not needed.",
    needs=("euler_poincare", "total_torque", "potential_energy"),
    runs=("derivations.motion.rate",),
    used_by=(
        "certreg.equilibrium.equilibrium_set.equilibrium_set",
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
