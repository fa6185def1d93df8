"""A motion on general springs: the valley of the energy it ended in, and what is known of that."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from certreg._loading import cached_property
from certreg.certificate.basin import SpringState, barrier_of, basin_of_springs
from certreg.certificate.checking import check_own, require_accepted
from certreg.certificate.listing import SpringsListBody, springs_list_certificate
from certreg.dynamics.trajectory import Trajectory
from certreg.equilibrium.equilibrium_set import unit_double
from certreg.equilibrium.paths import critical_lines
from certreg.exact.dyadic import power_of_two
from certreg.geometry.so3 import angle_between, dot, rotation_matrix, squared_norm
from certreg.problem.lifting import lift
from certreg.registration.nearby_equilibrium import TIE, equilibrium_near
from certreg.registration.simulation import SimulatedMotion
from certreg.registration.unobservable import Freedom
from certreg.registration.weakly_constrained import weak_shift_words, weak_shifts
from certreg.relaxation.optimum import Found, find_optimum
from certreg.results import Ruling, Verdict

if TYPE_CHECKING:
    from certreg.certificate.envelope import Certificate
    from certreg.dynamics.valleys import SprungBody
    from certreg.native.layout import Records
    from certreg.objective.springs import Springs


NEAR = 0.01  # radians: a body at rest is within a thousandth of its equilibrium, unless it is weak
LEVEL = 1e-5  # of the range of the energy: where the best rotation is not the only one
COASTS = "a body that moves that way coasts until damping has stopped it"
STAYS = "along it the body may be at rest (slower than the tolerance) far from the optimum"
UNLISTED = Verdict(
    ruling=Ruling.INCONCLUSIVE,
    words=(
        "Not proved that from its last state the exact motion ends at the optimum: no list of "
        "equilibria could be proved complete."
    ),
)


@dataclass(frozen=True, kw_only=True, eq=False)
class SimulatedSprings(SimulatedMotion):
    """On general springs; what is known of its end."""

    objective: Springs
    moving: SprungBody

    __repr__ = Trajectory.__repr__

    @cached_property
    def found(self) -> Found:
        """The best rotation that was found."""
        return find_optimum(self.objective)

    @cached_property
    def notes(self) -> tuple[str, ...]:  # pyright: ignore[reportIncompatibleMethodOverride]
        """What no spring resists, or hardly one, and what the body does there."""
        freedom = Freedom.of(self.objective)
        free = filter(None, (freedom.shift_words(), freedom.turn_words()))
        weak = weak_shift_words(weak_shifts(self.objective))
        told = (*((words, COASTS) for words in free), (weak, STAYS))
        return tuple(f"{words}: {then}" for words, then in told if words)

    @cached_property
    def angle_to_best(self) -> float:
        """Radians, from the last rotation to the nearest of the best that were found."""
        best = self.objective.energy(self.found.quaternion)
        ties = [q for q in self.found.minima if self.objective.energy(q) == best]
        end = np.array(self.quaternion)
        return min(angle_between(end, unit_double(q)) for q in (self.found.quaternion, *ties))

    @cached_property
    def excess(self) -> float:
        """The energy of the last rotation above the best that was found, over the energy's range.

        At the best translation; the range by its proved upper bound. 0 where it is constant.
        """
        above = self.objective.energy(self._quaternion)
        above -= self.objective.energy(self.found.quaternion)
        return float(above / self.objective.oscillation) if self.objective.oscillation else 0.0

    @property
    def at_best(self) -> bool:
        """Whether the last rotation is the best that was found."""
        return self.angle_to_best <= NEAR

    @cached_property
    def as_good(self) -> bool | None:
        """Whether the equilibrium at the last rotation is as good as the best that was found.

        None where that is not decided: where the energy is flat, Newton's steps do not reach it.
        """
        if self.at_best or not self.objective.oscillation:
            return True
        if self.excess <= (LEVEL if self.objective.symmetry else TIE):
            return True
        best = self.objective.energy(self.found.quaternion)
        near = equilibrium_near(self.objective, self.found.levelled, self._quaternion, best)
        if near.angle > NEAR:
            return None
        if near.ties:
            return True
        return False if near.is_worse else None

    @property
    def converged(self) -> bool:
        """Whether the body came to rest at the best rotation found, or at one that is as good."""
        return self.at_rest and self.as_good is True

    @property
    def outcome(self) -> str:
        """How it ended, in a sentence that rests on what was found, not on a proof."""
        if not self.at_rest:
            return self.status.value
        rest = "The body is at rest (slower than the tolerance)"
        if self.at_best:
            return f"{rest} at the best rotation found."
        if self.as_good is None:
            return f"{rest}; whether its rotation is as good as the best found is not decided."
        if self.as_good:
            return f"{rest} at a rotation as good as the best found."
        better = "springs hold it there, and a better rotation was found"
        return f"{rest} at another equilibrium: {better}."

    @property
    def end_words(self) -> str:
        """Where the last rotation is."""
        degrees = math.degrees(self.angle_to_best)
        digits = 3 if degrees >= 1.0 else 1  # a small one is rounding, or where a run was stopped
        away = f"{degrees:.{digits}g} degrees from the best rotation found"
        if self.at_best:
            return away
        if self.as_good:
            return f"{away}, and as good to within the tolerance"
        return f"{away}, {self.excess:.2g} of the energy's range above it"

    @cached_property
    def basin(self) -> Verdict:
        """Whether it is proved that the exact motion from the last state ends at the optimum."""
        certificate = self.listed
        if certificate is None:
            return UNLISTED
        barrier = barrier_of(self.objective, certificate.body)
        return basin_of_springs(self.objective, barrier, self.exact_end)

    @cached_property
    def listed(self) -> Certificate[SpringsListBody] | None:
        """The certificate of all equilibria, checked; None where none could be made."""
        lines = critical_lines(self.objective.floating_quartic()[0])
        certificate = springs_list_certificate(self.problem, self.objective, lines)
        if certificate is not None:
            require_accepted(check_own(certificate, self.problem))
        return certificate

    @property
    def exact_end(self) -> SpringState:
        """The last state, exactly as its doubles say, in the user's unit."""
        return exact_state(self.moving, self.last)

    @cached_property
    def _quaternion(self) -> list[int]:
        return lift(np.array(self.quaternion)).integers


def exact_state(moving: SprungBody, state: Records) -> SpringState:
    """A state of the body, exactly as its doubles say, in the user's unit."""
    unit = power_of_two(moving.length_exponent)
    q = lift(np.array(state["q"])).integers
    c, v, omega = ([Fraction(x) for x in state[part].tolist()] for part in ("c", "v", "omega"))
    norm = squared_norm(q)
    turned = [Fraction(dot(row, moving.centre), 1) / norm for row in rotation_matrix(q)]
    places = zip(moving.origin, c, turned, strict=True)
    return SpringState(
        quaternion=tuple(q),
        translation=tuple(origin + x * unit - r for origin, x, r in places),
        velocity=tuple(x * unit for x in v),
        angular_velocity=tuple(omega),
    )
