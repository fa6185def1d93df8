"""The result of `certify` for general springs: what is computed, and what the checker accepted."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from certreg._loading import cached_property
from certreg.certificate.bounds import sin2_half_angle_between
from certreg.exact.dyadic import half_angle_bound
from certreg.objective.neighbourhood import Neighbourhood
from certreg.problem.lifting import lift
from certreg.registration.any_registration import UNDECIDED, AnyRegistration, AnySolution, Method
from certreg.registration.covariance import FLAT, NOT_UNIQUE, OF_SPRINGS, covariance_at
from certreg.registration.curvature import soft_axes
from certreg.registration.freedom import Freedom
from certreg.registration.outlying import LISTED
from certreg.registration.spring_fit import spring_fit
from certreg.registration.spring_rows import ResidualSums, blocks_at, source_centre
from certreg.registration.weak_shifts import WeakShift, weak_shifts
from certreg.results import Absent

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy as np
    from numpy.typing import NDArray

    from certreg.geometry.pose import Pose
    from certreg.objective.springs import Springs
    from certreg.registration.any_registration import ResidualBlock
    from certreg.registration.covariance import PoseCovariance, Residual
    from certreg.registration.fit import Fit
    from certreg.registration.row_names import RowNames
    from certreg.relaxation.optimum import Found


NOT_LISTED = Absent(
    "general springs have up to forty equilibria, or infinitely many, which `certify` does not "
    "list, as its proof needs none of them: `certreg equilibria` lists them"
)
NOT_SIMULATED = Absent(
    "`certify` does not simulate the motion on general springs: `certreg simulate` does"
)
METHODS = {"springs-sos": Method.SQUARES, "springs-cones": Method.CONES}
SPRING_KINDS = tuple(METHODS)  # of certificates


@dataclass(frozen=True, kw_only=True, eq=False)
class SpringSolution(AnySolution):
    """What is computed before anything is checked; statistics when they are first asked for.

    found: the optimum as it was proposed, with the relaxation. quaternion: of the certified
        rotation, integers. pose: the same in doubles, with its best translation.
    """

    pose: Pose
    objective: Springs
    found: Found
    quaternion: tuple[int, int, int, int]

    @cached_property
    def freedom(self) -> Freedom:
        """What the springs leave undetermined, exactly."""
        return Freedom.of(self.objective)

    @cached_property
    def weak_shifts(self) -> tuple[WeakShift, ...]:
        """The shifts that the springs hardly resist: of rounding as much as of the data."""
        return weak_shifts(self.objective)

    @cached_property
    def least(self) -> Fraction:
        """The objective at the certified rotation with its best translation, exactly."""
        return self.objective.energy(self.quaternion)

    @cached_property
    def near(self) -> Neighbourhood:
        """The energy about the optimum, exactly."""
        return Neighbourhood(self.objective.reduced, self.quaternion, self.problem.motion)

    @cached_property
    def centre(self) -> tuple[Fraction, ...]:
        """The mean of the source in doubles, about which nothing cancels."""
        return source_centre(self.problem)

    @cached_property
    def sums(self) -> ResidualSums:
        """What one look at the rows says of the pose."""
        return ResidualSums.of(self.problem, self.pose, LISTED)

    def measured_covariance(self) -> PoseCovariance | Absent:
        """The covariance of the pose, computed now; why there is none."""
        if not self.unique:
            return UNDECIDED if self.unique is None else NOT_UNIQUE
        return covariance_at(
            self.problem,
            self.near,
            self.centre,
            least=self.least,
            carried=lambda: 2 * self.sums.effective_rows >= self.sums.rows,
            conditions=OF_SPRINGS,
        )

    def measured_fit(self, names: RowNames) -> Fit:
        """What the optimum is worth as a fit, computed now."""
        determined = self.unique is True and self.stated_covariance != FLAT
        return spring_fit(
            self.problem, self.sums, least=self.least, determined=determined, names=names
        )

    @property
    def method(self) -> Method | None:
        """How the certificate proves optimality; None without one."""
        return None if self.certificate is None else METHODS[self.certificate.body.KIND]

    @property
    def relaxation_value(self) -> Fraction | None:
        """The value of the relaxation, no bound, in the unit of the objective; None without one."""
        value, levelled = self.found.relaxation.value, self.found.levelled
        if value is None:
            return None
        return (Fraction(value) * levelled.scale + levelled.level) * self.objective.unit

    @property
    def angle_to_relaxation(self) -> float | Absent:
        """Radians from the pose to the rotation that is read off the relaxation."""
        q = self.found.relaxation.quaternion_wxyz
        if q is None:
            return Absent(self.found.relaxation.reason)
        return float(half_angle_bound(sin2_half_angle_between(self.quaternion, lift(q).integers)))

    @cached_property
    def soft_axes(self) -> NDArray[np.float64]:
        """(k, 3), the source's axes about which the energy hardly curves, in doubles."""
        return soft_axes(self.objective, self.quaternion)

    @property
    def near_minima(self) -> int:
        """How many local minima that were met may be optimal, as far as is proved; one at least."""
        if self.certificate is None:
            return 1
        most = self.least + self.certificate.body.gap
        return sum(self.objective.energy(q) <= most for q in self.found.minima) or 1

    @property
    def unique_rotation(self) -> bool | None:
        """Whether one rotation is optimal, as far as that is proved."""
        if self.certificate is not None and self.certificate.body.claims.unique is not None:
            return self.certificate.body.claims.unique
        return False if self.freedom.moves_optimum else None

    @property
    def unique(self) -> bool | None:
        """Whether one pose is optimal: a free shift makes others as good at any rotation."""
        return False if self.freedom.translations else self.unique_rotation

    def complete(self) -> None:
        """Compute all that reads points now: later their file may hold others."""
        _ = self.sums, self.stated_covariance, self.fit


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpringRegistration(AnyRegistration):
    """The result of `certify` for general springs: a solution, and what the checker accepted of it.

    It has what `Registration` has, but no list of equilibria and no motion: `certreg.equilibria`
    and `certreg.simulate` make them.

    Attributes
    ----------
    problem, solution
        What was asked, and what was found.
    objective
        sum r^T W r with r = y - R x - t at `pose`; None where no double holds it.
    rmse
        sqrt(objective / sum w), w the largest eigenvalue of W: in the unit of length.
    bounds
        Proved of `pose` as reported, rounding included; None if nothing is proved.
    limits
        Of the bounds, within which the pose is called certified.
    verdict
        The checker's, with the theorems in its words; None if there is no certificate.
    timings
        Seconds per phase.
    absent
        Why an attribute is None, by its name.
    """

    solution: SpringSolution

    __repr__ = AnyRegistration.__repr__

    @property
    def pose(self) -> Pose:
        """The optimum in doubles; of several the one that the solution chose."""
        return self.solution.pose

    @property
    def equilibria(self) -> None:
        """None: `certreg.equilibria` lists those of general springs."""
        return

    @property
    def trajectory(self) -> None:
        """None: `certreg.simulate` moves general springs."""
        return

    @property
    def method(self) -> Method | None:
        """What proves the gap: the certificate, or, where that is coarser, the energy itself.

        The energy is a sum of squares, so that no gap is larger than the energy.
        """
        bounds, certificate = self.bounds, self.certificate
        if bounds is None or certificate is None:
            return None
        own = bounds.greatest_gap - bounds.least_gap < certificate.body.gap
        return Method.ENERGY if own and bounds.least_range_squared else self.solution.method

    def stated(self, name: str) -> Any:
        """The attribute of that name, or the Absent that stands for it.

        Parameters
        ----------
        name
            Of an attribute that may be None.

        Returns
        -------
        Any
            Its value; where that is None, the reason.
        """
        return NOT_LISTED if name == "equilibria" else AnyRegistration.stated(self, name)

    def worst_residuals(self, count: int) -> list[Residual]:
        """The rows that are farthest off along their springs, at most ten.

        Parameters
        ----------
        count
            How many.

        Returns
        -------
        list[Residual]
            Rows and how far they are off, the farthest first.
        """
        return list(self.solution.sums.worst[:count])

    @property
    def degrees_of_freedom(self) -> int:
        """Of the residuals, all six parameters of the pose counted."""
        return self.problem.degrees_of_freedom

    def residual_blocks(self) -> Iterator[ResidualBlock]:
        """All rows: slices, how far each is off along its springs, and sqrt(r^T W r)."""
        for rows, at in blocks_at(self.problem, self.pose):
            yield rows, at.along, at.strained
