"""The result of `certify`: a pose, what is computed of it, and what the checker has accepted."""

from __future__ import annotations

import enum
from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, Self

import numpy as np

from certreg._loading import cached_property
from certreg.registration.exit_codes import code_of_status
from certreg.registration.optimum import exact_pose
from certreg.registration.robustness import NONE_PROVED, Robustness
from certreg.registration.row_names import RowNames
from certreg.results import (
    Absent,
    Explained,
    Limits,
    Optimality,
    Saved,
    Verdict,
    present,
    presenter,
)

if TYPE_CHECKING:
    from fractions import Fraction

    from numpy.typing import NDArray
    from typing_extensions import TypeVar

    from certreg.certificate.bounds import ExactPose, PoseBounds
    from certreg.certificate.envelope import Certificate
    from certreg.equilibrium.equilibrium_set import EquilibriumSet
    from certreg.geometry.pose import Pose
    from certreg.geometry.similarity import Similarity
    from certreg.objective.isotropic import Isotropic
    from certreg.objective.springs import Springs
    from certreg.objective.structure import Structure
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.covariance import PoseCovariance, Residual
    from certreg.registration.fit import Fit
    from certreg.registration.simulation import SimulatedMotion
    from certreg.registration.unobservable import Freedom
    from certreg.registration.weakly_constrained import WeakShift
    from certreg.registration.whitened_residuals import SpringAxes

    ResidualBlock = tuple[slice, NDArray[np.float64], NDArray[np.float64]]
    Solved_co = TypeVar("Solved_co", bound="Solution", covariant=True, default=Any)
else:
    from typing import TypeVar

    Solved_co = TypeVar("Solved_co", covariant=True)

HELD = ("covariance", "equilibria", "trajectory")  # by the solution, which says why one is missing
ALIKE = Absent("each pair has one weight, and a spring alike in every way")
ALL_COUNT = Absent("all pairs count: none is labelled")
UNDECIDED = Absent("whether the optimum is unique is not decided")


class Method(enum.Enum):
    """How optimality is proved; the value is the word used in files."""

    SPECTRAL = "spectral"  # eigenvalues, of one weight per pair
    SQUARES = "sos-4"  # a sum of squares of degree four
    CONES = "cones"  # branch and bound on cones of quaternions
    ENERGY = "energy"  # the energy itself: no energy is negative


class PoseWorth(NamedTuple):
    """What a pose costs, exactly.

    mean_square: of the RMSE; None where there is none. bounds: None where nothing is proved.
    """

    energy: Fraction
    mean_square: Fraction | None
    bounds: PoseBounds | None


@dataclass(frozen=True, kw_only=True, eq=False)
class Solution(Explained, ABC):
    """What is computed before anything is checked; what no proof needs when it is first asked for.

    problem: as stated. objective: its energy. pose: the optimum in doubles. certificate: None if
    none was found. trajectory: the simulated motion; Absent says why there is none.
    """

    problem: RegistrationProblem
    objective: Isotropic | Springs
    pose: Pose | Similarity
    certificate: Certificate[Any] | None
    trajectory: SimulatedMotion | Absent

    @cached_property
    def freedom(self) -> Freedom | Absent:
        """What springs leave undetermined, exactly; of weights alone the equilibria say it."""
        return ALIKE

    @cached_property
    def weak_shifts(self) -> tuple[WeakShift, ...]:
        """The shifts that are hardly resisted: of one weight per pair there are none."""
        return ()

    @property
    @abstractmethod
    def unique(self) -> bool | None:
        """Whether one pose is optimal; None where that is not decided."""

    @property
    @abstractmethod
    def unique_rotation(self) -> bool | None:
        """Whether one rotation is optimal; None where that is not decided."""

    @abstractmethod
    def measured_covariance(self) -> PoseCovariance | Absent:
        """The covariance of the pose, computed now; why there is none."""

    @abstractmethod
    def measured_fit(self, names: RowNames) -> Fit:
        """What the optimum is worth as a fit, computed now."""

    @abstractmethod
    def complete(self) -> None:
        """Compute all that reads points now: later their file may hold others."""

    @abstractmethod
    def worth(self, place: ExactPose, body: Any) -> PoseWorth:
        """What a pose costs, and what a body of a certificate of this problem proves of it."""

    def squares(self, objective: float) -> float:
        """The sum of weighted squares at the pose, of its objective."""
        return objective

    @abstractmethod
    def method_by(self, bounds: PoseBounds) -> Method:
        """What proves the gap within such bounds of the pose."""

    @abstractmethod
    def residual_blocks(self) -> Iterator[ResidualBlock]:
        """All rows at the pose: slices, residuals, and these in deviations of weight one."""

    @abstractmethod
    def worst_residuals(self, count: int) -> list[Residual]:
        """The rows that fit worst at the pose, at most so many, the worst first."""

    def spring_axes(self, rows: NDArray[np.int64]) -> SpringAxes | None:
        """Along which axes the springs of some rows pull; None where weights pull along all."""
        del rows
        return None

    @property
    @abstractmethod
    def equilibria(self) -> EquilibriumSet | Any:
        """All equilibria, where they are listed; None where `stated` says why not."""

    def as_proved(self, body: Any) -> Self:
        """The same, with what a body given proves."""
        own = self.certificate
        if own is None:
            return self
        return replace(self, certificate=replace(own, body=self.merged(own.body, body)))

    def merged(self, own: Any, given: Any) -> Any:
        """The body given, in the place of its own."""
        del own
        return given

    def told_robustness(self, found: Robustness) -> Robustness:
        """With what else the certificate proves to stay near while points are off by less."""
        return found

    @cached_property
    def stated_covariance(self) -> PoseCovariance | Absent:
        """The covariance of the pose, or why there is none."""
        return self.measured_covariance()

    @property
    def covariance(self) -> PoseCovariance | None:
        """Of the pose; None where the optimum is not unique or no double holds it."""
        return present(self.stated_covariance)

    @cached_property
    def fit(self) -> Fit:
        """What the optimum is worth as a fit, by statistics; nothing of it is proved."""
        about = {} if self.certificate is None else self.certificate.about
        return self.measured_fit(RowNames.of(about, self.problem.n))

    def stated(self, name: str) -> Any:
        """The attribute of that name, or the Absent that stands for it."""
        return self.stated_covariance if name == "covariance" else Explained.stated(self, name)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Registration(Explained, Saved, Generic[Solved_co]):
    """The result of `certify`: a solution, and what the checker has accepted of it.

    Attributes
    ----------
    problem, solution
        What was asked, and what was found.
    objective
        At `pose`, sum w |y - R x - t|^2, on general springs sum r^T W r with r = y - R x - t; None
        where no double holds it.
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

    problem: RegistrationProblem
    solution: Solved_co
    objective: float | None
    rmse: float | None
    bounds: PoseBounds | None
    limits: Limits
    verdict: Verdict | None
    timings: dict[str, float]

    def __repr__(self) -> str:
        rmse = "beyond doubles" if self.rmse is None else f"{self.rmse:.6g}"
        codes = ", ".join(code.value for code in self.fit.codes)
        warned = f"; the fit: {codes}" if codes else ""
        return f"<Registration: {self.status.value}; n={self.problem.n}, rmse={rmse}{warned}>"

    @property
    def pose(self) -> Pose | Similarity:
        """The optimum in doubles; of several the one that the solution chose."""
        return self.solution.pose

    @property
    def certificate(self) -> Certificate[Any] | None:
        """The certificate that the checker has accepted; None if none was found."""
        return self.solution.certificate

    @property
    def unique(self) -> bool | None:
        """Whether there is one optimal pose; None where that is not decided."""
        return self.solution.unique

    @property
    def covariance(self) -> PoseCovariance | None:
        """Of the pose; None where the optimum is not unique or no double holds it."""
        return present(self.solution.stated_covariance)

    @property
    def fit(self) -> Fit:
        """What the optimum is worth as a fit, by statistics; nothing of it is proved."""
        return self.solution.fit

    @property
    def robustness(self) -> Robustness | None:
        """How far the points may be off, proved; None where that is not, or not asked for."""
        certificate = self.certificate
        radius = None if certificate is None else getattr(certificate.body, "radius", None)
        return None if radius is None else self.solution.told_robustness(Robustness.of(radius))

    @property
    def status(self) -> Optimality:
        """What is proved of the pose; never more than the checker has accepted."""
        if self.verdict is None or not self.verdict.proved or self.bounds is None:
            return Optimality.NOT_CERTIFIED
        turned = self.solution.unique_rotation is True
        if self.unique is None or not self.bounds.meet(self.limits, unique=turned):
            return Optimality.BOUNDED
        return Optimality.CERTIFIED if self.unique else Optimality.CERTIFIED_NOT_UNIQUE

    @property
    def exit_code(self) -> int:
        """What `certify` ends with: 0; 3 where several poses are optimal; 4 for less."""
        return code_of_status(self.status)

    @property
    def headline(self) -> str:
        """What is proved, in words: the first line that the command line prints."""
        return presenter().headline(self)

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
        if name in HELD:
            return self.solution.stated(name)
        if name == "robustness":
            return self.robustness or NONE_PROVED
        if name == "labels":
            return ALL_COUNT
        return Explained.stated(self, name)

    @property
    def residuals(self) -> NDArray[np.float64]:
        """(N,), how far each pair is off at `pose`, in the unit of length."""
        return np.concatenate([distances for _, distances, _ in self.residual_blocks()])

    def as_proved(self, body: Any) -> Self:
        """The same, with what a certificate given proves of the pose: no more, and no less.

        Parameters
        ----------
        body
            Of that certificate.

        Returns
        -------
        Self
            With its bounds.
        """
        bounds = self.solution.worth(exact_pose(self.pose), body).bounds
        return replace(self, solution=self.solution.as_proved(body), bounds=bounds)

    @property
    def structure(self) -> Structure:
        """Of the objective: what its proof rests on."""
        return self.solution.objective.structure

    @property
    def method(self) -> Method | None:
        """How its gap is proved; None where it is not."""
        if self.bounds is None or self.certificate is None:
            return None
        return self.solution.method_by(self.bounds)

    @property
    def equilibria(self) -> EquilibriumSet | Any:
        """All equilibria of the registration dynamics; None on general springs.

        There they are listed by `certreg.equilibria`.
        """
        return self.solution.equilibria

    @property
    def labels(self) -> tuple[str, ...] | None:
        """Of each pair; None: all count, as with a loss of squares."""
        return None

    @property
    def trajectory(self) -> SimulatedMotion | None:
        """The simulated motion; None where none was taken."""
        return present(self.solution.trajectory)

    @property
    def degrees_of_freedom(self) -> int:
        """Of the residuals, all parameters of the pose counted."""
        return self.problem.degrees_of_freedom

    def residual_blocks(self) -> Iterator[ResidualBlock]:
        """All rows: slices, residuals, and these in standard deviations of weight one.

        A residual is a distance; on general springs it is how far a row is off along its springs.
        """
        return self.solution.residual_blocks()

    def worst_residuals(self, count: int) -> list[Residual]:
        """The rows that fit worst at `pose`.

        Parameters
        ----------
        count
            How many; of general springs ten at most.

        Returns
        -------
        list[Residual]
            Rows and residuals, the largest first; of equal ones the first row.
        """
        return self.solution.worst_residuals(count)

    def plot(self, axes: Any = None) -> Any:
        """The clouds at the pose, drawn by Matplotlib.

        Parameters
        ----------
        axes
            To draw into, of a flat projection; None for a figure of its own.

        Returns
        -------
        matplotlib.axes.Axes
            What was drawn into.

        Raises
        ------
        MissingToolError
            Without Matplotlib.
        """
        return presenter().plot(self, axes)
