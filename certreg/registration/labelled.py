"""What all registrations of wrong pairs have: the fit over the inliers, and its parts."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

from certreg.registration.consensus_words import repeated_rows, repeated_words
from certreg.registration.pair_warnings import reason_against
from certreg.registration.row_names import RowNames
from certreg.results import Saved

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.equilibrium.presentation import EquilibriumSet
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.covariance import PoseCovariance
    from certreg.registration.misfits import FitWarning
    from certreg.registration.result import Registration
    from certreg.registration.robustness import Robustness
    from certreg.registration.simulation import SimulatedMotion


class LabelledRegistration(Saved, ABC):
    """A registration whose pairs are labelled; the pose is that of the least squares over inliers.

    What a `Registration` says of its pose is said here of the same least squares, `fit`: they are
    no statement about the other pairs.
    """

    __slots__ = ()

    problem: RegistrationProblem
    fit: Registration
    certificate: Any

    @property
    def objective(self) -> float | None:
        """That of `fit`."""
        return self.fit.objective

    @property
    def rmse(self) -> float | None:
        """That of `fit`, in the unit of length."""
        return self.fit.rmse

    @property
    def covariance(self) -> PoseCovariance | None:
        """That of `fit`: as if all inliers were right pairs."""
        return self.fit.covariance

    @property
    def robustness(self) -> Robustness | None:
        """That of `fit`."""
        return self.fit.robustness

    @property
    def equilibria(self) -> EquilibriumSet | Any:
        """Those of `fit`."""
        return self.fit.equilibria

    @property
    def trajectory(self) -> SimulatedMotion | None:
        """That of `fit`."""
        return self.fit.trajectory

    def stated(self, name: str) -> Any:
        """An attribute of `fit`, or the Absent that stands for it.

        Parameters
        ----------
        name
            Of an attribute that may be None.

        Returns
        -------
        Any
            Its value; where that is None, the reason.
        """
        return self.fit.stated(name)

    @property
    def names(self) -> RowNames:
        """Of the rows."""
        about: dict[str, Any] = {} if self.certificate is None else self.certificate.about
        return RowNames.of(about, self.problem.n)

    @property
    @abstractmethod
    def met_rows(self) -> Sequence[int]:
        """Rows of the pairs over which `fit` is taken."""

    @property
    @abstractmethod
    def pair_warnings(self) -> tuple[FitWarning, ...]:
        """What the proof of the labels does not tell of the pairs."""

    @property
    def warnings(self) -> tuple[FitWarning, ...]:
        """The same, and those of the least squares."""
        return (*self.pair_warnings, *self.fit.fit.warnings)

    @property
    def against(self) -> str | None:
        """What is to be said in the headline against pairs and pose; None where nothing is."""
        return reason_against(self.fit, self.pair_warnings)

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know of the pairs."""
        again = repeated_rows(self.problem, self.met_rows)
        return (repeated_words(again, self.names),) if again else ()
