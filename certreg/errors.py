"""What certreg raises: what is wrong, where, the remedy, and the evidence."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from certreg.results import Verdict


class CertregError(Exception):
    """Anything certreg refuses to do. The message is one line, written for the user."""


class InvalidProblemError(CertregError):
    """The arrays given do not state a registration problem."""


class DegenerateProblemError(CertregError):
    """The problem is well posed, but what was asked of it is not defined."""


class InvalidFileError(CertregError):
    """A file cannot be read, or does not hold what its name promises."""


class MissingToolError(CertregError):
    """A program that was asked for is not installed, or does not work."""


class OutOfRangeError(CertregError):
    """A result exists, but no double can hold it."""


class CampaignError(CertregError):
    """A campaign cannot begin or go on; what is done is kept."""


class UndecidedError(CertregError):
    """What was asked could not be decided on this road; nothing is wrong with the problem."""


class ContradictionError(CertregError):
    """Two independent roads to the same answer disagree: a defect, never to be ignored."""


class RefusedCertificateError(CertregError):
    """The checker refused certreg's own certificate: a defect, never to be ignored."""

    def __init__(self, message: str, *, verdict: Verdict) -> None:
        super().__init__(message)
        self.verdict = verdict


class SlowSimulationWarning(UserWarning):
    """Simulations run, but slower than they could; the message says why. Told once."""
