"""The certified basin of general springs: the whole barrier, decided in exact arithmetic.

Where every spring direction is resisted (S > 0) and the source is not collinear (J > 0), the states
with V_p + V_k <= E are a compact set, which the motion never leaves, and every motion tends to the
equilibria in it. If E is below the energy of all equilibria but the optimum, that is one.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

from certreg.exact.elimination import rank
from certreg.geometry.so3 import quadratic_form, squared_norm
from certreg.results import Brief, Ruling, Verdict

if TYPE_CHECKING:
    from certreg.certificate.listing import SpringsListBody
    from certreg.objective.springs import Springs

THEOREM = (
    "From its last state the exact motion ends at the optimum: its energy is below that of every "
    "other equilibrium."
)
OPEN = "Not proved that from its last state the exact motion ends at the optimum: "
SHIFTS = f"{OPEN}some shift meets no spring, so that the body may end anywhere along it."
COLLINEAR = f"{OPEN}the source is collinear, so that its rotational dynamics is not defined."
TIED = f"{OPEN}it is not unique, or not proved to be, so that there is no barrier."
ABOVE = f"{OPEN}its energy is not below that of every other equilibrium."
WITHIN = f"{OPEN}its energy is within the bounds of that of another equilibrium."


@dataclass(frozen=True, slots=True, kw_only=True)
class SpringState(Brief):
    """A state of the body, exact, in the user's unit.

    quaternion: integers, of any length; translation: as in y = R x + t; velocity: of the centre of
    mass (masses tr W / 3); angular_velocity: in the frame of the body, radians.
    """

    quaternion: tuple[int, ...]
    translation: tuple[Fraction, ...]
    velocity: tuple[Fraction, ...]
    angular_velocity: tuple[Fraction, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Barrier(Brief):
    """Proved bounds of the least energy of all equilibria but the optimum; None: not known."""

    lower: Fraction | None
    upper: Fraction | None = None


def barrier_of(objective: Springs, body: SpringsListBody) -> Barrier:
    """The bounds that an accepted list of all equilibria proves.

    The second critical line lies within its box: each entry within 1 of that of p = (2^bits, ...),
    so that the rotation is within 8 / 2^bits radians. Along a turn the energy changes by at most
    twice its range per radian (Bernstein: trigonometric, of degree 2, about its middle).
    """
    if body.claims.unique is not True or len(body.quaternions) < 2:
        return Barrier(lower=None)
    second = objective.energy(body.quaternions[1])
    width = 16 * objective.oscillation / (1 << body.bits)
    return Barrier(lower=body.claims.second.value, upper=second + width)


def basin_of_springs(objective: Springs, barrier: Barrier, state: SpringState) -> Verdict:
    """Whether a state has less energy than every equilibrium but the optimum.

    PROVED: then the exact motion from it ends at the optimum, for any damping > 0. REFUTED: it has
    as much; where the motion ends is not said.
    """
    if objective.free_translations:
        return Verdict(ruling=Ruling.INCONCLUSIVE, words=SHIFTS)
    if rank(objective.mass_scatter) < 2:
        return Verdict(ruling=Ruling.INCONCLUSIVE, words=COLLINEAR)
    if barrier.lower is None:
        return Verdict(ruling=Ruling.INCONCLUSIVE, words=TIED)
    energy = state_energy(objective, state)
    if energy < barrier.lower:
        return Verdict(
            ruling=Ruling.PROVED,
            words=f"Proved: {THEOREM[0].lower()}{THEOREM[1:]}",
            tell=partial(tuple, (THEOREM,)),
        )
    if barrier.upper is not None and energy >= barrier.upper:
        return Verdict(ruling=Ruling.REFUTED, words=ABOVE)
    return Verdict(ruling=Ruling.INCONCLUSIVE, words=WITHIN)


def state_energy(objective: Springs, state: SpringState) -> Fraction:
    """V_p + V_k of a state: sum (y - R x - t)^T W (y - R x - t) + M |v|^2 / 2 + w^T J w / 2."""
    q, omega = state.quaternion, state.angular_velocity
    energy = objective.energy(q) + objective.translation_energy(q, state.translation)
    scatter = objective.mass_moments
    spread = sum((scatter.scatter[k][k] for k in range(3)), Fraction(0))
    spin = spread * squared_norm(omega) - quadratic_form(scatter.scatter, omega)
    return energy + (scatter.mass * squared_norm(state.velocity) + spin) / 2
