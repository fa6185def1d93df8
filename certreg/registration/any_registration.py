"""What every registration has, of springs of any kind: a pose, what is proved of it, files."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from certreg.registration.robustness import Robustness
from certreg.results import Explained, Optimality, Presented, presenter

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from certreg.certificate import Certificate, PoseBounds
    from certreg.dynamics import Trajectory
    from certreg.geometry import Pose
    from certreg.problem import RegistrationProblem
    from certreg.registration.covariance import PoseCovariance, Residual
    from certreg.registration.fit import Fit
    from certreg.results import Limits, Verdict

    ResidualBlock = tuple[slice, NDArray[np.float64], NDArray[np.float64]]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AnyRegistration(Explained, Presented):
    """A pose of a problem, and what the checker has accepted of it.

    What depends on the springs is said by `Registration`, of one weight per pair, and by
    `SpringRegistration`, of a matrix per pair; those who take either need no more than this.

    problem: as it was stated. objective, rmse: at exactly the printed pose, rounded once; None
    beyond the doubles. bounds: what is proved of the printed pose; None if nothing is. limits: what
    must be proved of it to be called certified. verdict: of the checker on the certificate, None
    without one. timings: seconds per phase.
    """

    problem: RegistrationProblem
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
    def pose(self) -> Pose:
        """The optimum in doubles."""
        raise NotImplementedError

    @property
    def certificate(self) -> Certificate[Any] | None:
        """The certificate that the checker has accepted; None if none was found."""
        raise NotImplementedError

    @property
    def unique(self) -> bool | None:
        """Whether there is one optimal pose; None where that is not decided."""
        raise NotImplementedError

    @property
    def covariance(self) -> PoseCovariance | None:
        """Of the pose; None where the optimum is not unique or no double holds it."""
        raise NotImplementedError

    @property
    def fit(self) -> Fit:
        """What the optimum is worth as a fit, by statistics; nothing of it is proved."""
        raise NotImplementedError

    @property
    def robustness(self) -> Robustness | None:
        """How far the points may be off, proved; None where that is not, or not asked for."""
        certificate = self.certificate
        radius = None if certificate is None else getattr(certificate.body, "radius", None)
        return None if radius is None else Robustness.of(radius)

    @property
    def status(self) -> Optimality:
        """What is proved of the pose; never more than the checker has accepted."""
        raise NotImplementedError

    @property
    def trajectory(self) -> Trajectory | None:
        """The simulated motion; None where none was taken."""
        raise NotImplementedError

    @property
    def degrees_of_freedom(self) -> int:
        """Of the residuals, all six parameters of the pose counted."""
        raise NotImplementedError

    def residual_blocks(self) -> Iterator[ResidualBlock]:
        """All rows: slices, residuals, and these in standard deviations of weight one."""
        raise NotImplementedError

    def worst_residuals(self, count: int) -> list[Residual]:
        """The rows that fit worst, at most so many, the worst first."""
        raise NotImplementedError

    def report(self, path: str | os.PathLike[str]) -> Path:
        """Write one HTML file that shows the registration and its proof, offline.

        Parameters
        ----------
        path
            Of the file; it is written whole or not at all.

        Returns
        -------
        Path
            Of the file.

        Raises
        ------
        InvalidFileError
            Where there is no certificate, or the file cannot be written.
        """
        return presenter().report(self, path)

    def save(self, folder: str | os.PathLike[str]) -> Path | None:
        """Write what `certify --out` writes.

        Parameters
        ----------
        folder
            Made if it is missing.

        Returns
        -------
        Path | None
            Of the certificate; None where there is none.

        Raises
        ------
        InvalidFileError
            Where the files cannot be written.
        """
        return presenter().save(self, folder)

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
