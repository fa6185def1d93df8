"""Many problems: their results one after the other, or their certificates at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sized
from typing import TYPE_CHECKING, Any, Literal, overload

from certreg.certificate.many import Certificates, certificates_of
from certreg.errors import CertregError, InvalidProblemError
from certreg.problem.many import ManyPairs
from certreg.registration.certification import certify

if TYPE_CHECKING:
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration.result import Registration

    Problem = RegistrationProblem | tuple[Any, Any]
    Progress = Callable[[int, int | None], object]


@overload
def certify_many(
    problems: Any,
    targets: Any,
    *,
    weights: Any = None,
    progress: Progress | None = None,
) -> Certificates: ...


@overload
def certify_many(
    problems: Iterable[Problem],
    *,
    errors: Literal["raise"] = "raise",
    progress: Progress | None = None,
    **options: Any,
) -> list[Registration]: ...


@overload
def certify_many(
    problems: Iterable[Problem],
    *,
    errors: Literal["keep"],
    progress: Progress | None = None,
    **options: Any,
) -> list[Registration | CertregError]: ...


def certify_many(
    problems: Iterable[Problem],
    targets: Any = None,
    *,
    errors: Literal["raise", "keep"] = "raise",
    progress: Progress | None = None,
    **options: Any,
) -> list[Any] | Certificates:
    """The certificates of many problems, or all that `certify` says of them, in their order.

    `certify_many(sources, targets, weights=None)`: the certificates, a hundred thousand in seconds.
    They are proved as they are made and not checked once more, except those that compiled code
    cannot prove: these are made one by one, as by `certify`. `verify.py` checks the file that
    `save` writes.

    `certify_many(problems, **options)`: the results of `certify`. One process, one problem at a
    time: for files on many processors, that survives a kill, take `certreg batch`; for millions of
    small problems in floating point, `certreg.solve_many`.

    Parameters
    ----------
    problems
        Each a `RegistrationProblem`, or a pair (source, target). Beside `targets` the sources:
        (count, N, 3), a list of clouds (N, 3) of different N, or one (N, 3) for all, which are
        copied.
    targets
        As the sources.
    errors
        "raise" the first, with a note that says of which problem, counted from 0; or "keep" it in
        the place of the result.
    progress
        Called with the number that is done and that of all, None where nobody knows it.
    **options
        As of `certify`, the same for all. Beside `targets` the `weights` alone: (count, N), a list,
        (N,) or a number for all; where none are given they are 1.

    Returns
    -------
    list[Any] | Certificates
        A `Registration` of each problem; of one that is refused the error, where these are kept.
        Beside `targets` the certificates.

    Raises
    ------
    CertregError
        That of the first problem that `certify` refuses, where errors are not kept.
    InvalidProblemError
        For other words in `errors`.

    Examples
    --------
    >>> cloud = [[0, 0, 0], [1, 0, 0], [0, 2, 0]]
    >>> certify_many([(cloud, cloud)], simulation=False, progress=print)
    1 1
    [<Registration: certified; n=3, rmse=0>]
    >>> many = certify_many([cloud, cloud], cloud)
    >>> many.unique.tolist(), bool((many.angles < 1e-12).all())
    ([True, True], True)
    """
    if targets is not None:
        return _certificates(problems, targets, errors=errors, progress=progress, **options)
    if errors not in {"raise", "keep"}:
        raise InvalidProblemError(
            f"errors is {errors!r}: give 'raise' or 'keep'", array="errors", value=errors
        )
    total = len(problems) if isinstance(problems, Sized) else None
    results: list[Registration | CertregError] = []
    for number, problem in enumerate(problems):
        stated = problem if isinstance(problem, tuple) else (problem,)
        try:
            results.append(certify(*stated, **options))
        except CertregError as error:
            if errors == "raise":
                error.add_note(f"problem {number} (counting from 0)")
                raise
            results.append(error)
        if progress is not None:
            progress(number + 1, total)
    return results


def _certificates(
    sources: Any,
    targets: Any,
    *,
    errors: str,
    progress: Progress | None,
    weights: Any = None,
    **options: Any,
) -> Certificates:
    """Of clouds. Raises InvalidProblemError for what only results have."""
    if options or errors != "raise":
        given = ", ".join(options) or "errors"
        raise InvalidProblemError(
            f"{given} beside sources and targets, whose certificates take weights alone: give a "
            "list of problems (RegistrationProblem)",
            array=given,
        )
    return certificates_of(ManyPairs.of(sources, targets, weights), progress)
