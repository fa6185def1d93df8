"""What certreg raises: what is wrong, where, the remedy, and the evidence.

The message is for the user, the fields are for programs: whoever catches an error reads the row or
the file from it and need not parse the message. A field is None where it does not apply, or where
the place that noticed the fault does not know it. Errors travel between processes with the fields.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.results import Verdict


class CertregError(Exception):
    """Anything certreg refuses to do. The message is one line, written for the user."""


class InvalidProblemError(CertregError):
    """The arguments given do not state a registration problem.

    array: the argument that is wrong, as in the signature: source, weights, sigma, damping.
    row: the first row of it that is wrong; instance: of many, the problem; both counted from 0.
    value: what stands there: a number, a row, a type, a shape, a count.
    limit: what the value would have to be, or to keep to.
    """

    def __init__(
        self,
        message: str,
        *,
        array: str | None = None,
        row: int | None = None,
        instance: int | None = None,
        value: object = None,
        limit: object = None,
    ) -> None:
        super().__init__(message)
        self.array = array
        self.row = row
        self.instance = instance
        self.value = value
        self.limit = limit


class DegenerateProblemError(CertregError):
    """The problem is well posed, but what was asked of it is not defined.

    rank: of the centred source: 1 if its points are collinear, 0 if they are all the same.
    instance: of many problems, this one, counted from 0.
    value: what is too small or too large, if it is a number; limit: what it misses.
    """

    def __init__(
        self,
        message: str,
        *,
        rank: int | None = None,
        instance: int | None = None,
        value: object = None,
        limit: object = None,
    ) -> None:
        super().__init__(message)
        self.rank = rank
        self.instance = instance
        self.value = value
        self.limit = limit


class InvalidFileError(CertregError):
    """A file cannot be read or written, or does not hold what its name promises.

    path: the file or folder. line: counted from 1, of text and headers. row: counted from 0, of
    points, weights and pairs. column: the name of a column, a field or a key.
    value: what stands there. limit: what it would have to be, or to keep to.
    """

    def __init__(  # noqa: PLR0913 - a place in a file has four coordinates
        self,
        message: str,
        *,
        path: Path | None = None,
        line: int | None = None,
        row: int | None = None,
        column: str | None = None,
        value: object = None,
        limit: object = None,
    ) -> None:
        super().__init__(message)
        self.path = path
        self.line = line
        self.row = row
        self.column = column
        self.value = value
        self.limit = limit


class MissingToolError(CertregError):
    """A program that was asked for is not installed, or does not work.

    tool: its name, or that of the library.
    """

    def __init__(self, message: str, *, tool: str | None = None) -> None:
        super().__init__(message)
        self.tool = tool


class OutOfRangeError(CertregError):
    """A result exists, but no double can hold it.

    value: the result, exactly or as a power of two, where it is known.
    """

    def __init__(self, message: str, *, value: object = None) -> None:
        super().__init__(message)
        self.value = value


class CampaignError(CertregError):
    """A campaign cannot begin or go on; what is done is kept.

    path: the folder in its way. address: of the scheduler that does not answer. shard: the one on
    which a worker failed. value: what a worker has; limit: what it should have.
    """

    def __init__(
        self,
        message: str,
        *,
        path: Path | None = None,
        address: str | None = None,
        shard: int | None = None,
        value: object = None,
        limit: object = None,
    ) -> None:
        super().__init__(message)
        self.path = path
        self.address = address
        self.shard = shard
        self.value = value
        self.limit = limit


class UndecidedError(CertregError):
    """What was asked could not be decided by this method; nothing is wrong with the problem.

    method: its name.
    """

    def __init__(self, message: str, *, method: str | None = None) -> None:
        super().__init__(message)
        self.method = method


class ContradictionError(CertregError):
    """Two independent methods give different answers: a defect, never to be ignored.

    methods: the names of those that differ. value: by how much; limit: how much may be.
    """

    def __init__(
        self,
        message: str,
        *,
        methods: tuple[str, ...] = (),
        value: object = None,
        limit: object = None,
    ) -> None:
        super().__init__(message)
        self.methods = methods
        self.value = value
        self.limit = limit


class RefusedCertificateError(CertregError):
    """The checker refused certreg's own certificate: a defect, never to be ignored."""

    def __init__(self, message: str, *, verdict: Verdict) -> None:
        super().__init__(message)
        self.verdict = verdict


class UnusedSpringsWarning(UserWarning):
    """The target has normals or covariances that were not asked for: pairs are points."""


class UnusedNoiseWarning(UserWarning):
    """A cloud has a column `sigma` or `weight` that was not asked for: all pairs count alike."""


class NotCompiledWarning(UserWarning):
    """Where nothing is compiled, something runs slower or proves less; the message says why."""
