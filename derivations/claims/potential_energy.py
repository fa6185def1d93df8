"""Claim: the potential energy of the springs in terms of moments, off SO(3) and on it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from certreg.geometry.so3 import davenport_matrix, quadratic_form

from ..algebra import combination, contraction, identity, modulo
from ..hypotheses import BOTH_CENTRED, CENTRED, ROTATION, UNIT, moments
from ..kernel import Claim, Mutation, Proof
from ..moments import MomentCloud, PointCloud
from ..motion import Body, State, position, potential, potential_energy, unit_cloud
from ..notation import inner, quaternion, rotation, square

Energy = Callable[[State, MomentCloud], Any]


def closed_form(state: State, cloud: MomentCloud) -> Any:
    """M |c|^2 + tr T2 + tr(R S2 R^T) - 2 tr(R^T C), for any matrix R."""
    stretched = inner(state.R.T * state.R, cloud.source_scatter)
    constant = cloud.mass * square(state.c) + cloud.target_scatter.trace()
    return constant + stretched - 2 * inner(state.R, cloud.cross)


def proof(energy: Energy = potential_energy, form: Energy = closed_form) -> Proof:
    """The sum over the springs for any matrix R, then for rotations, then in quaternions."""
    state, cloud, body = State(), MomentCloud(), Body()
    spread = cloud.target_scatter.trace() + cloud.source_scatter.trace()
    aligned = cloud.mass * square(state.c) + spread - 2 * inner(state.R, cloud.cross)
    yield identity(
        r"A spring of stiffness $k = 2m$ between $y$ and $Rx + c$ stores "
        r"$\tfrac12 k\,|y - Rx - c|^2 = m\,|y - Rx - c|^2$. Summed over the centred points, for "
        r"every matrix $R$: $V_p = M|c|^2 + \sum m|y|^2 + \operatorname{tr}(R S_2 R^{\mathsf T}) "
        r"- 2\operatorname{tr}(R^{\mathsf T}C)$. Terms linear in $c$ vanish with the centring, so "
        r"translation and rotation do not mix.",
        energy(state, cloud),
        form(state, cloud),
    )
    yield combination(
        r"Where $R$ is a rotation, $\operatorname{tr}(R S_2 R^{\mathsf T}) = \operatorname{tr}S_2$:"
        r" the difference is $\langle S_2, R^{\mathsf T}R - I\rangle$. So the rotation enters "
        r"through $-2\operatorname{tr}(R^{\mathsf T}C)$ alone.",
        form(state, cloud) - aligned,
        contraction(cloud.source_scatter, ROTATION),
    )
    yield from _in_quaternions(energy)
    for n in (3, 4):
        yield _written_out(n, form)
    yield combination(
        r"The generated code computes $V_p/M$ as $|c|^2 + \mathrm{spread} - "
        r"2\operatorname{tr}(R^{\mathsf T}C/M)$. Where $R$ is a rotation that is this energy of a "
        r"cloud of mass 1 with the body's moments.",
        energy(state, unit_cloud(body)) - potential(state, body),
        contraction(unit_cloud(body).source_scatter, ROTATION),
    )


def _in_quaternions(energy: Energy) -> Proof:
    cloud, q = MomentCloud(), quaternion()
    state = State(R=rotation(q))
    spread = cloud.target_scatter.trace() + cloud.source_scatter.trace()
    davenport = quadratic_form(davenport_matrix(cloud.cross.tolist()), tuple(q))
    yield modulo(
        r"With $R = R(q)$, $|q| = 1$: $V_p = M|c|^2 + \mathrm{spread} - 2\,q^{\mathsf T}K(C)\,q$, "
        r"where $\mathrm{spread} = \operatorname{tr}S_2 + \sum m|y|^2$. This is the exact rational "
        r"number that the code reports as the potential energy of a quaternion. Low energy means a "
        r"large value of one quadratic form on the unit sphere of $\mathbb R^4$.",
        energy(state, cloud),
        cloud.mass * square(state.c) + spread - 2 * davenport,
        [UNIT],
    )


def _written_out(n: int, form: Energy) -> Any:
    points, state = PointCloud.of_size(n), State()
    pairs = list(zip(points.sources, points.targets, strict=True))
    energy = points.total([square(y - position(state, x)) for x, y in pairs])
    return combination(
        rf"Once more with $N = {n}$ springs written out: the sum over the springs less the closed "
        r"form is a combination of the entries of $\sum m\,x$ and $\sum m\,y$, which vanish.",
        energy - form(state, moments(points)),
        [
            *contraction(2 * state.R.T * state.c, CENTRED[n, "x"]),
            *contraction(-2 * state.c, CENTRED[n, "y"]),
        ],
    )


def _transposed(state: State, cloud: MomentCloud) -> Any:
    return closed_form(state, cloud) + 2 * inner(state.R - state.R.T, cloud.cross)


CLAIM = Claim(
    name="potential_energy",
    title="Potential energy",
    statement=r"$V_p = \sum m\,|y - Rx - c|^2 = M|c|^2 + \sum m|y|^2 + "
    r"\operatorname{tr}(R S_2 R^{\mathsf T}) - 2\operatorname{tr}(R^{\mathsf T}C)$ for every "
    r"matrix $R$. Where $R = R(q)$ is a rotation: $V_p = M|c|^2 + \operatorname{tr}S_2 + "
    r"\sum m|y|^2 - 2\,q^{\mathsf T}K(C)\,q$ with $|q| = 1$.",
    concludes=(1, 2, 3, 4, 5),
    hypotheses=(ROTATION, UNIT, *BOTH_CENTRED),
    source="[Yang2020], the potential energy in the proof of convergence to equilibria",
    proof=proof,
    controls={
        "springs of stiffness m": Mutation(
            at=1,
            proof=lambda: proof(energy=lambda state, cloud: potential_energy(state, cloud) / 2),
        ),
        "C transposed": Mutation(at=1, proof=lambda: proof(form=_transposed)),
        "translation without its mass": Mutation(
            at=1,
            proof=lambda: proof(
                form=lambda state, cloud: (
                    closed_form(state, cloud) + (1 - cloud.mass) * square(state.c)
                )
            ),
        ),
    },
    not_claimed=r"That $R$ can leave $\mathrm{SO}(3)$ without a change of the formula: off it the "
    r"term $\operatorname{tr}(R S_2 R^{\mathsf T})$ is not constant.",
    needs=("davenport", "quaternions"),
    runs=("derivations.motion.potential",),
    used_by=(
        "certreg.objective.isotropic.Isotropic.energy",
        "certreg.dynamics.body.AnyBody.energies",
    ),
    coq=(
        "potential_reduction",
        "davenport_form",
    ),
    not_in_coq="The formula for a matrix $R$ that is no rotation.",
)
