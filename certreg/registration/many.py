"""Many problems, certified one after the other."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, overload

from certreg.errors import CertregError, InvalidProblemError
from certreg.registration.certification import certify

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from certreg.problem import RegistrationProblem
    from certreg.registration.result import Registration

    Problem = RegistrationProblem | tuple[Any, Any]
    Progress = Callable[[int, int | None], object]


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
    *,
    errors: Literal["raise", "keep"] = "raise",
    progress: Progress | None = None,
    **options: Any,
) -> list[Any]:
    """The results of `certify` for many problems, in their order.

    One process, one problem at a time: for files on many processors, that survives a kill, take
    `certreg batch`; for millions of small problems in floating point, `certreg.solve_many`.

    Parameters
    ----------
    problems
        Each a `RegistrationProblem`, or a pair (source, target).
    errors
        "raise" the first, with a note that says of which problem, counted from 0; or "keep" it in
        the place of the result.
    progress
        Called with the number that is done and that of all, None where nobody knows it.
    **options
        As of `certify`, the same for all.

    Returns
    -------
    list[Any]
        A `Registration` of each problem; of one that is refused the error, where these are kept.

    Raises
    ------
    CertregError
        That of the first problem that `certify` refuses, where errors are not kept.
    ValueError
        For other words in `errors`.

    Examples
    --------
    >>> cloud = [[0, 0, 0], [1, 0, 0], [0, 2, 0]]
    >>> certify_many([(cloud, cloud)], simulation=False, progress=print)
    1 1
    [<Registration: certified; n=3, rmse=0>]
    """
    if errors not in {"raise", "keep"}:
        message = f"errors is {errors!r}: give 'raise' or 'keep'"
        raise InvalidProblemError(message, array="errors", value=errors)
    total = len(problems) if hasattr(problems, "__len__") else None  # pyright: ignore[reportArgumentType]
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
