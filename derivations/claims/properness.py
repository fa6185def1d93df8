"""Claim: the energy keeps the motion in a compact set of SO(3) x R^9; off SO(3) it need not."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy

from ..algebra import Square, combination, facts, identity, nonnegative, positive
from ..hypotheses import MASSES, PRINCIPAL, SPECTRAL, WHERE_ROTATION, moments
from ..hypothesis import Hypothesis, Standing, vanishing
from ..kernel import Claim, Mutation, Proof, Step
from ..moments import MomentCloud, PointCloud, inertia_of
from ..motion import State, body_kinetic_energy, position, potential_energy
from ..notation import Array, Matrix, diagonal, inner, matrix, scalar, square, vector
from ..rings import rational

Energy = Callable[[State, MomentCloud], Any]
SCALES = (0, 1, 10**3, 10**6, 10**12)


def coplanar(normal: Array) -> Hypothesis:
    """S2 n = 0 and C n = 0, as where n . x = 0 for every point."""
    cloud = MomentCloud()
    return vanishing(
        r"For the second part: the cloud lies in a plane with normal $n$, so that $S_2 n = 0$ and "
        r"$C n = 0$.",
        Matrix.vstack(cloud.source_scatter * normal, cloud.cross * normal),
        standing=Standing.CASE,
        solves=(*sorted(cloud.source_scatter.free_symbols, key=str), *cloud.cross),
    )


NORMAL = vector("n")
FLAT = coplanar(NORMAL)


def proof(energy: Energy = potential_energy, flat: Hypothesis = FLAT) -> Proof:
    """Lower bounds for the parts of V; compactness; the ambient space, coplanar and not."""
    yield from _translation(energy)
    yield from _spin()
    yield _compact()
    yield from _ambient(energy, flat)


def _translation(energy: Energy) -> Proof:
    state, cloud = State(), MomentCloud()
    residuals = cloud.total(square(cloud.y - state.R * cloud.x))
    yield identity(
        r"$V_p = M|c|^2 + \sum m\,|y - Rx|^2$ for every matrix $R$, the mixed term being linear in "
        r"the centred points. So $V \ge M|c|^2 + \tfrac12 M|v|^2 + \tfrac12\,\omega^{\mathsf T}"
        r"J\omega$: bounded below by $0$, and growing with $c$ and $v$.",
        energy(state, cloud),
        cloud.mass * square(state.c) + residuals,
    )
    for n in (3, 4):
        points = PointCloud.of_size(n)
        source, target = points.total(points.sources), points.total(points.targets)
        pairs = list(zip(points.sources, points.targets, strict=True))
        stored = points.total([square(y - position(state, x)) for x, y in pairs])
        apart = stored - points.mass * square(state.c) + 2 * inner(state.c, target)
        masses = MASSES[n].parts
        yield nonnegative(
            rf"Once more with $N = {n}$ springs written out; the terms with $\sum m\,x$ and "
            r"$\sum m\,y$, which vanish, are moved to the left: $V_p - M|c|^2$ is a sum of "
            r"squares.",
            apart - 2 * inner(state.R.T * state.c, source),
            [
                [m, Square(entry)]
                for m, (x, y) in zip(masses, pairs, strict=True)
                for entry in y - state.R * x
            ],
        )
        yield positive(
            r"$M > 0$, so that these bounds can be divided by it.",
            points.mass,
            [[mass] for mass in masses],
        )


def _spin() -> Proof:
    d, omega, Q = diagonal("d"), vector("omega"), matrix("Q")
    S = MomentCloud().source_scatter
    yield identity(
        r"For the spin, take the body's axes along the principal axes of $S_2$. In axes turned by "
        r"an orthogonal matrix $Q$ the scatter is $Q^{\mathsf T}S_2Q$ and the velocity "
        r"$Q^{\mathsf T}\omega$; their form is $\omega^{\mathsf T}(QQ^{\mathsf T})S_2(QQ^{\mathsf "
        r"T})\,\omega$ and the trace is $\operatorname{tr}(S_2QQ^{\mathsf T})$, so with "
        r"$QQ^{\mathsf T} = I$ neither changes, and the eigenvalues of $J$ do not either.",
        [(omega.T * Q * (Q.T * S * Q) * Q.T * omega)[0], (Q.T * S * Q).trace()],
        [(omega.T * (Q * Q.T) * S * (Q * Q.T) * omega)[0], (S * Q * Q.T).trace()],
    )
    J = inertia_of(d)
    trace, determinant = J.trace(), J.det()
    values = PRINCIPAL.parts
    yield nonnegative(
        r"In these axes $J$ is diagonal with entries $j_1, j_2, j_3 \ge 0$, and "
        r"$j_1\,(\operatorname{tr}J)^2 - j_1 j_2 j_3$ multiplied out has nonnegative terms only. "
        r"Hence $(\operatorname{tr}J)^2\,\omega^{\mathsf T}J\omega \ge \det(J)\,|\omega|^2$, in "
        r"any axes: with $\det J > 0$ the energy grows with $\omega$, and $\omega^{\mathsf "
        r"T}J\omega = 0$ only for $\omega = 0$.",
        trace**2 * (omega.T * J * omega)[0] - determinant * square(omega),
        spin_terms(omega, values),
    )
    yield solid_determinant()


def solid_determinant() -> Step:
    """The determinant of J is positive."""
    return positive(
        r"And $\det J = j_1 j_2 j_3 > 0$, as three of the points are not collinear.",
        inertia_of(diagonal("d")).det(),
        [PRINCIPAL.parts],
    )


def spin_terms(omega: Array, values: list[Any]) -> list[list[Any]]:
    """The products of j_1, j_2, j_3 in (tr J)^2 j_k - j_1 j_2 j_3, each with omega_k^2."""
    found: list[list[Any]] = []
    for k, speed in enumerate(omega):
        a, b, c = values[k], values[(k + 1) % 3], values[(k + 2) % 3]
        others = ([a, a], [b, b], [c, c], [2, a, b], [2, a, c], [b, c])
        found.extend([a, *factors, Square(speed)] for factors in others)
    return found


def _compact() -> Any:
    R = State().R
    return combination(
        r"The rotations are compact: $\lVert R\rVert^2 = 3$ on $\mathrm{SO}(3)$, a closed set. So "
        r"$\{V \le E\}$ is closed and $|c|^2 \le E/M$, $|v|^2 \le 2E/M$, $|\omega|^2 \le "
        r"2E\,(\operatorname{tr}J)^2/\det J$ on it: compact, for every $E$. In particular $V_p$ "
        r"has a minimum.",
        square(R) - 3,
        [(1, part) for part in WHERE_ROTATION.diagonal],
    )


def _ambient(energy: Energy, flat: Hypothesis) -> Proof:
    state, cloud = State(), MomentCloud()
    R, s, u, n = state.R, scalar("s"), vector("u"), NORMAL
    moved = State(R=R + s * u * n.T)
    yield combination(
        r"In the paper's ambient space $R$ is any matrix. If the cloud is coplanar with unit "
        r"normal $n$, then $n\cdot x = 0$ for every point, so $S_2 n = 0$ and $Cn = 0$. Then "
        r"$V_p(R + s\,u n^{\mathsf T}) = V_p(R)$ for all $s$ and $u$: the difference is a "
        r"combination of the entries of $S_2 n$ and $Cn$. The energy is constant along a line "
        r"that leaves every bounded set: not radially unbounded.",
        energy(moved, cloud) - energy(state, cloud),
        [
            *zip(
                [*(2 * s * R.T * u + s**2 * square(u) * n), *(-2 * s * u)], flat.parts, strict=True
            ),
        ],
    )
    yield _triangle(energy)
    yield identity(
        r"If the cloud is not coplanar, it is so: for every matrix $R$, $V_p - M|c|^2 + \sum "
        r"m|y|^2 - \tfrac12\operatorname{tr}(R S_2 R^{\mathsf T}) = \tfrac12\sum m\,|Rx - 2y|^2 "
        r"\ge 0$, and $\operatorname{tr}(R S_2 R^{\mathsf T})$ grows with $R$ where $S_2 \succ 0$.",
        2 * (energy(state, cloud) - cloud.mass * square(state.c) + cloud.target_scatter.trace())
        - inner(R.T * R, cloud.source_scatter),
        cloud.total(square(R * cloud.x - 2 * cloud.y)),
    )


def _triangle(energy: Energy) -> Any:
    """A right triangle in the plane x_3 = 0, registered to itself and stretched along x_3."""
    corners = [Matrix(p) for p in ((2, -1, 0), (-1, 2, 0), (-1, -1, 0))]
    one = sympy.Integer(1)
    cloud = moments(PointCloud((one,) * 3, tuple(corners), tuple(corners)))
    found = []
    for scale in SCALES:
        R = sympy.diag(1, 1, 1 + scale)
        state = State(c=sympy.zeros(3, 1), R=R, v=sympy.zeros(3, 1), omega=sympy.zeros(3, 1))
        found.append(energy(state, cloud) + body_kinetic_energy(state, cloud))
    return facts(
        r"An example in integers: the right triangle $(2,-1,0)$, $(-1,2,0)$, $(-1,-1,0)$ with "
        r"unit weights, registered to itself. At $R = \operatorname{diag}(1, 1, 1+s)$, at rest, "
        r"the total energy is $0$ for $s = 0, 1, 10^3, 10^6, 10^{12}$, though three of the points "
        r"are not collinear.",
        [rational(value) for value in found],
        [0] * len(SCALES),
    )


CLAIM = Claim(
    name="properness",
    title="The energy confines the motion",
    statement=r"On $\mathrm{SO}(3)\times\mathbb R^9$ with $J \succ 0$: $V \ge 0$, and every set "
    r"$\{V \le E\}$ is compact, with $|c|^2 \le E/M$, $|v|^2 \le 2E/M$, $|\omega|^2 \le "
    r"2E\,(\operatorname{tr}J)^2/\det J$. In the ambient space $\mathbb R^{18}$ the energy is "
    r"constant along a line if the source is coplanar, so it is not radially unbounded there.",
    concludes=(1, 2, 3, 4, 5, 7, 8, 9, 10),
    hypotheses=(*MASSES.values(), PRINCIPAL, WHERE_ROTATION, FLAT),
    source="[Yang2020], the total energy and the footnote on its growth",
    proof=proof,
    controls={
        "springs along x and y only": Mutation(
            at=1,
            proof=lambda: proof(
                lambda state, cloud: potential_energy(state, cloud) - cloud.mass * state.c[2] ** 2
            ),
        ),
        "a direction that is not normal": Mutation(
            at=10, proof=lambda: proof(flat=coplanar(vector("k")))
        ),
        "springs of stiffness m": Mutation(
            at=1, proof=lambda: proof(lambda state, cloud: potential_energy(state, cloud) / 2)
        ),
    },
    not_claimed="That the paper's conclusion fails for coplanar clouds: on rotations it holds, "
    "only the reason given for it does not.",
    needs=("potential_energy", "inertia"),
    standard=(SPECTRAL,),
    runs=("derivations.motion.potential_energy",),
    used_by=("certreg.dynamics.simulation.simulate",),
    not_in_coq="No theorem in Coq speaks of compactness.",
)
