"""An energy near a pose, to second order in what the motion is free to change, exactly.

A motion takes M = s R to M exp([phi]), phi about the source's axes, and s to s + ds where the scale
is free; the translation follows. So with r = (1, vec M) and V = r^T Q r, along e_k, and along ds

    dM = M [e_k], R,    d2M = M (e_k e_l^T + e_l e_k^T) / 2 - delta_kl M,
    dV = 2 dr^T Q r,    d2V = 2 dr^T Q dr' + 2 d2r^T Q r;

d2M of a turn and the scale is along a turn, in which V does not change at an optimum.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import lcm
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import cached_property
from certreg.exact.dyadic import power_of_two, quotient_or_zero
from certreg.exact.elimination import definite_inverse
from certreg.geometry.so3 import rotation_matrix, squared_norm
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.objective.form import Reduced
    from certreg.problem.motion import Motion

Integers = Any  # arrays of Python's, which do not overflow
Inverse = tuple[Integers, int]
SPARE_BITS = 64  # of a Hessian beside twice those of q: what is off by q's last bit, squared
EYE: Integers = np.eye(3, dtype=int).astype(object)
CROSSES: Integers = np.cross(EYE[:, np.newaxis], EYE)  # [e_k]^T


@dataclass(frozen=True)
class Neighbourhood(Brief):
    """The energy of a form about a rotation R(q), a scale and the best translation."""

    form: Reduced
    quaternion: Sequence[int]
    motion: Motion
    scale: Fraction = Fraction(1)

    @cached_property
    def over(self) -> int:
        """What `tangents` are over."""
        return squared_norm(self.quaternion) * self.scale.denominator

    @property
    def unit(self) -> Fraction:
        """What 1 is worth in `gradient` and `hessian`, in units of the energy."""
        return self.form.unit / self.over**2

    @cached_property
    def _columns(self) -> Integers:
        """(3, 3), the transpose of |q|^2 R."""
        return np.array(rotation_matrix(self.quaternion), dtype=object).T

    @cached_property
    def tangents(self) -> Integers:
        """(k, 9), vec dM of the turns about the source's axes and of a free scale."""
        scale, over = self.scale.as_integer_ratio()
        turns = (scale * CROSSES @ self._columns).reshape(3, 9)
        growth = over * self._columns.reshape(1, 9)
        free = self.motion.parameters_given(translation=False)
        return np.concatenate([turns, growth])[:free]

    @cached_property
    def _quadratic(self) -> Integers:
        """Q, 10x10."""
        return np.array(self.form.rows, dtype=object)

    @cached_property
    def _pull(self) -> Integers:
        """(9,), Q r, but for its first entry."""
        place = self.scale.numerator * self._columns.ravel()
        return self._quadratic[1:] @ np.concatenate([[self.over], place])

    @property
    def gradient(self) -> Integers:
        """(k,), dV."""
        return 2 * (self.tangents @ self._pull)

    @cached_property
    def hessian(self) -> Integers:
        """(k, k), d2V; mixed with the scale, at an optimum."""
        found = 2 * (self.tangents @ self._quadratic[1:, 1:] @ self.tangents.T)
        bent = self.scale.numerator * (self._columns @ self._pull.reshape(3, 3).T)
        found[:3, :3] += bent + bent.T - 2 * np.trace(bent) * EYE
        return found

    @cached_property
    def inverse(self) -> Inverse | None:
        """The adjugate and the determinant of `hessian`; None if it is not positive definite."""
        largest: int = np.abs(self.hessian).max()
        kept = 2 * max(map(abs, self.quaternion)).bit_length() + SPARE_BITS
        spare = max(0, largest.bit_length() - kept)
        found = definite_inverse((self.hessian >> spare).tolist())
        return found and (np.array(found[1], dtype=object), found[0] << spare)

    @cached_property
    def shifts(self) -> tuple[Integers, int]:
        """How the best translation moves: (3, k) integers over a number."""
        up, down = power_of_two(self.form.length_exponent).as_integer_ratio()
        response = np.array(self.form.response, dtype=object)[:, 1:]
        return up * (response @ self.tangents.T), self.form.determinant * down * self.over

    def moves(self, point: Sequence[Fraction]) -> NDArray[np.float64]:
        """(3, k), how the image of a point of the source moves, each entry rounded once."""
        (shifts, over), whole = self.shifts, lcm(*(entry.denominator for entry in point))
        arm = [entry.numerator * (whole // entry.denominator) for entry in point]
        swung = np.array(arm, dtype=object) @ self.tangents.reshape(-1, 3, 3)
        return _rounded(whole * shifts + over // self.over * swung.T, whole * over)

    def half_hessian(self, point: Sequence[Fraction]) -> NDArray[np.float64]:
        """Half of d2V, and first, if the motion has them, of shifts of the image of a point.

        In doubles, infinite beyond. What a shift costs is said by S.
        """
        unit, form, count = self.unit, self.form, len(self.motion.axes)
        bent = _rounded(unit.numerator * self.hessian, 2 * unit.denominator)
        above, below = form.stiffness_unit.as_integer_ratio()
        stiff = _rounded(above * np.array(form.stiffness, dtype=object), below)[:count, :count]
        moved = self.moves(point)[:count]
        pulled = stiff @ moved
        return np.block([[stiff, -pulled], [-pulled.T, bent + moved.T @ pulled]])


def _rounded(rows: Integers, over: int) -> NDArray[np.float64]:
    """Quotients of integers, each rounded once."""
    return np.array([[quotient_or_zero(entry, over) for entry in row] for row in rows.tolist()])
