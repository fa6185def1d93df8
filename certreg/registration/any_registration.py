"""What every registration has, of springs of any kind: a pose, what is proved of it, files."""

from __future__ import annotations

import enum
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg._loading import cached_property
from certreg.registration.robustness import NONE_PROVED, Robustness
from certreg.registration.row_names import RowNames
from certreg.results import Absent, Explained, Optimality, Saved, present, presenter

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from certreg.certificate import Certificate, PoseBounds
    from certreg.dynamics import Trajectory
    from certreg.equilibrium import EquilibriumSet
    from certreg.geometry import Pose, Similarity
    from certreg.problem import RegistrationProblem
    from certreg.registration.covariance import PoseCovariance, Residual
    from certreg.registration.fit import Fit
    from certreg.registration.freedom import Freedom
    from certreg.registration.weak_shifts import WeakShift
    from certreg.results import Limits, Verdict

    ResidualBlock = tuple[slice, NDArray[np.float64], NDArray[np.float64]]

ALIKE = Absent("each pair has one weight, and a spring alike in every way")
UNDECIDED = Absent("whether the optimum is unique is not decided")


class Method(enum.Enum):
    """How optimality is proved; the value is the word used in files."""

    SPECTRAL = "spectral"  # eigenvalues, of one weight per pair
    SQUARES = "sos-4"  # a sum of squares of degree four
    CONES = "cones"  # branch and bound on cones of quaternions
    ENERGY = "energy"  # the energy itself: no energy is negative


@dataclass(frozen=True, kw_only=True, eq=False)
class AnySolution(Explained, ABC):
    """What is computed before anything is checked; what no proof needs when it is first asked for.

    problem: as stated. pose: the optimum in doubles. certificate: None if none was found.
    """

    problem: RegistrationProblem
    pose: Pose | Similarity
    certificate: Certificate[Any] | None

    @property
    @abstractmethod
    def unique(self) -> bool | None:
        """Whether one pose is optimal; None where that is not decided."""

    @property
    @abstractmethod
    def unique_rotation(self) -> bool | None:
        """Whether one rotation is optimal; None where that is not decided."""

    @cached_property
    def freedom(self) -> Freedom | Absent:
        """What springs leave undetermined, exactly; of weights alone the equilibria say it."""
        return ALIKE

    @cached_property
    def weak_shifts(self) -> tuple[WeakShift, ...]:
        """The shifts that are hardly resisted: of one weight per pair there are none."""
        return ()

    @abstractmethod
    def measured_covariance(self) -> PoseCovariance | Absent:
        """The covariance of the pose, computed now; why there is none."""

    @abstractmethod
    def measured_fit(self, names: RowNames) -> Fit:
        """What the optimum is worth as a fit, computed now."""

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
class AnyRegistration(Explained, Saved, ABC):
    """A pose of a problem, and what the checker has accepted of it.

    What depends on the springs is said by `Registration`, of one weight per pair, and by
    `SpringRegistration`, of a matrix per pair; those who take either need no more than this.

    problem: as it was stated. solution: what was found. objective, rmse: at exactly the printed
    pose, rounded once; None beyond the doubles. bounds: what is proved of the printed pose; None if
    nothing is. limits: what must be proved of it to be called certified. verdict: of the checker on
    the certificate, None without one. timings: seconds per phase.
    """

    problem: RegistrationProblem
    solution: AnySolution
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
        name = type(self).__name__
        return f"<{name}: {self.status.value}; n={self.problem.n}, rmse={rmse}{warned}>"

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
        if name == "covariance":
            return self.solution.stated_covariance
        if name == "robustness":
            return self.robustness or NONE_PROVED
        return Explained.stated(self, name)

    @property
    def residuals(self) -> NDArray[np.float64]:
        """(N,), how far each pair is off at `pose`, in the unit of length."""
        return np.concatenate([distances for _, distances, _ in self.residual_blocks()])

    @property
    @abstractmethod
    def equilibria(self) -> EquilibriumSet | None:
        """All equilibria; None where `certify` lists none."""

    @property
    @abstractmethod
    def trajectory(self) -> Trajectory | None:
        """The simulated motion; None where none was taken."""

    @property
    @abstractmethod
    def degrees_of_freedom(self) -> int:
        """Of the residuals, all parameters of the pose counted."""

    @abstractmethod
    def residual_blocks(self) -> Iterator[ResidualBlock]:
        """All rows: slices, residuals, and these in standard deviations of weight one."""

    @abstractmethod
    def worst_residuals(self, count: int) -> list[Residual]:
        """The rows that fit worst, at most so many, the worst first."""

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
