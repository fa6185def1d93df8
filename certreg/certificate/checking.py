"""The checker's answer as a Verdict: the only word on whether a certificate proves its claims."""

from __future__ import annotations

import hashlib
import os
import sys
from array import array
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Any

from certreg._loading import late
from certreg.certificate.envelope import Certificate, CertificateBody, certificate_bytes
from certreg.certificate.refusals import told_apart, why_no_certificate, why_no_certificates
from certreg.errors import InvalidProblemError, RefusedCertificateError
from certreg.io.atomic import write_atomically
from certreg.results import SHOWN, Ruling, Shown, Verdict
from certreg.verify import INLINE_MAX, LIMITS, Clouds, Limits, Outcome, Worth, check, main

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.problem import bounds as problem_bounds
    from certreg.problem.problem import RegistrationProblem
    from certreg.problem.terms import Named
else:
    # it loads NumPy, which most here do without
    problem_bounds = late("certreg.problem.bounds")


OBJECTIVES = {"consensus": "--max-residual", "truncated": "--objective truncated"}  # of models
UNITS = {"angle": "radians", "share": "a number", "undecided": "a number of pairs"}
# Of own certificates: so few the checker adds up itself, in 20 ms. From `MANY_POINTS` on there are
# two exact methods besides, and a certificate is made with one of them.
PYTHON_POINTS = 2048


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class CertificateVerdict(Verdict, Shown):
    """The checker's answer; weigh: finds `worth`, the exact numbers that it proved of the pose.

    None: nothing is proved, or the certificate is of a kind that names no pose.
    """

    weigh: Callable[[], Worth | None] = field(
        default=type(None), compare=False, metadata={SHOWN: "worth"}
    )

    @property
    def worth(self) -> Worth | None:
        """What is proved of the pose, in numbers, found when it is read."""
        return self.weigh()


def verify(  # noqa: PLR0913 - each limit is one question, and is asked for seldom
    certificate: str | os.PathLike[str] | bytes | Certificate[CertificateBody],
    problem: RegistrationProblem | Clouds | None = None,
    *,
    max_angle: float | Fraction | None = None,
    max_gap: float | Fraction | None = None,
    max_undecided: int | None = None,
    max_residual: Any = None,
    objective: str | None = None,
) -> CertificateVerdict:
    """Re-check a certificate in exact arithmetic: a path, the bytes of the file, or as made.

    Parameters
    ----------
    certificate
        What is to be checked; nothing in it is trusted. Of a folder, its certificate.json.
    problem
        If given, the certificate must be about exactly these points and weights; needed where the
        certificate is too large to carry its points.
    max_angle, max_gap
        Refuse where the proved bound on the angle to the optima, in radians, or on the gap, as a
        share of the range of energies, is larger, or where there is none.
    max_undecided
        Refuse where more pairs have no proved label, of pairs that may be wrong, and certificates
        without labels.
    max_residual, objective
        Beside a problem: the bounds that its pairs had, and what was sought with them, as for
        `certreg.certify`.

    Returns
    -------
    CertificateVerdict
        PROVED carries the theorems and their numbers; REFUTED means that the certificate does not
        prove its claims, which is not a proof that they are false.

    Raises
    ------
    InvalidFileError
        If the file cannot be read.
    InvalidProblemError
        Where a limit is no number, or below 0, or a mapped cloud is spoilt meanwhile; where bounds
        are none, or stand beside no problem.
    """
    content = certificate_bytes(certificate)
    limits = _limits(angle=max_angle, share=max_gap, undecided=max_undecided)
    if max_residual is not None or objective is not None:
        problem = bounded_clouds(problem, max_residual, objective)
    elif not (problem is None or isinstance(problem, Clouds)) and problem.loss.kind in OBJECTIVES:
        problem = bounded_clouds(problem, problem.bounds, problem.loss.kind)
    if problem is None or isinstance(problem, Clouds) or problem.n <= INLINE_MAX:
        clouds = _bound(problem)
        outcome = check(content, clouds, limits)
        if not outcome.verified:
            reason = why_no_certificate(outcome.reason, content)
            told = reason if clouds is None else told_apart(reason, content, clouds)
            outcome = replace(outcome, reason=told)
        return as_verdict(outcome)
    from certreg.certificate.blockwise import check_in_blocks  # loads NumPy, for large ones alone

    return as_verdict(check_in_blocks(content, problem, limits))


def verify_lines(
    path: str | os.PathLike[str],
    *,
    max_angle: float | Fraction | None = None,
    max_gap: float | Fraction | None = None,
    max_undecided: int | None = None,
) -> int:
    """What `verify.py` prints of a file with a certificate a line, and its exit code.

    Of a file of results it is one line.
    """
    mistaken = why_no_certificates(path)
    if mistaken is not None:
        sys.stdout.write(f"REFUSED: {mistaken}\n")
        return 1
    limits = _limits(angle=max_angle, share=max_gap, undecided=max_undecided)
    given = ((option, limits.get(name)) for option, name in LIMITS.items())
    options = [f"--{option}={float(limit)!r}" for option, limit in given if limit is not None]
    return main([*options, "--", os.fspath(path)])


def _limits(**limits: float | Fraction | None) -> Limits:
    """Those that are given; a float is the decimal number that it is written as: 1e-5 is 1/10^5."""
    found: dict[str, Fraction] = {}
    for name, limit in limits.items():
        if limit is not None:
            unit = UNITS[name]
            try:
                found[name] = limit if isinstance(limit, Fraction) else Fraction(repr(float(limit)))
            except (TypeError, ValueError) as error:
                raise InvalidProblemError(
                    f"the limit of the {name} is {limit!r}: give {unit}", array=name, value=limit
                ) from error
            if found[name] < 0:
                raise InvalidProblemError(
                    f"the limit of the {name} is {limit!r}: give {unit}, 0 or more",
                    array=name,
                    value=limit,
                )
    return found


def verify_with_coq(
    certificate: str | os.PathLike[str] | bytes,
    problem: RegistrationProblem | Clouds | None = None,
    *,
    out: Path | None = None,
) -> Verdict:
    """The same question, decided by Coq's kernel through a checker that is proved correct.

    out: where to keep the Coq file that was decided on. Raises MissingToolError without Coq.
    """
    from certreg.certificate.coq import decide  # few ask for Coq

    verdict, source = decide(certificate_bytes(certificate), _bound(problem), tell=_on_stderr)
    if out is not None and source:
        write_atomically(out, source.encode())
    return verdict


def _on_stderr(words: str) -> None:
    sys.stderr.write(words + "\n")


def _bound(problem: RegistrationProblem | Clouds | None) -> Clouds | None:
    return problem if problem is None or isinstance(problem, Clouds) else _clouds(problem)


def check_own(
    certificate: Certificate[CertificateBody], problem: RegistrationProblem
) -> CertificateVerdict:
    """The checker's answer on a certificate just made, from its bytes, as a stranger would.

    The bytes are those of `line`: the file has the same entries, with other space between them.

    Of many points it does not add up all products again, which takes a stranger 15 seconds for a
    million: its proofs are run on exact sums by another method than those that it is made of. That
    is as good: parser, digest and every proof are the checker's, and of the sums, integers on which
    no rounding acts, each method is the other's test. Both are compiled, and share nothing that
    multiplies or adds: one keeps an accumulator for every exponent of a product of signed integers,
    the other multiplies digits in fixed point, without signs and exponents (`problem.exact_sums`);
    what does not fit there goes by NumPy, in matrices of limbs. Only where both err alike, in one
    integer, would a wrong certificate pass; and `certreg verify` adds up anew, always.

    That few points in the file are those of the problem is certain where it is this problem that
    the file is written from; else it is seen from their digest, to which the checker binds them.

    Theorems and numbers are written and found when they are read.
    """
    if problem.n <= PYTHON_POINTS:
        inline, content = certificate.inline, certificate.line()
        same = inline is problem or (
            inline is not None
            and hashlib.sha256(problem.data_bytes()).hexdigest() == certificate.digest
        )
        return _verdict(check(content)) if same else verify(content, problem)
    from certreg.certificate.blockwise import check_on_sums  # as above

    return _verdict(check_on_sums(replace(certificate, inline=None).line(), problem))


def check_own_consensus(certificate: Certificate[CertificateBody]) -> CertificateVerdict:
    """The same of pairs with bounds: so few that the checker reads them from the bytes."""
    return as_verdict(check(certificate.line()))


def as_verdict(outcome: Outcome) -> CertificateVerdict:
    """The checker's outcome, three-valued, of which no points are kept: they may be many."""
    tell, weigh = partial(tuple, outcome.theorems), partial(_itself, outcome.worth)
    return replace(_verdict(outcome), tell=tell, weigh=weigh)


def _itself(worth: Worth | None) -> Worth | None:
    return worth


def _verdict(outcome: Outcome) -> CertificateVerdict:
    """The checker's outcome, three-valued."""
    if not outcome.verified:
        return CertificateVerdict(ruling=Ruling.REFUTED, words=outcome.reason)
    words = "every claim of the certificate is proved"
    return CertificateVerdict(
        ruling=Ruling.PROVED, words=words, tell=outcome.tell, weigh=outcome.weigh
    )


def _clouds(problem: RegistrationProblem, *beside: Named, option: str = "") -> Clouds:
    """The arrays of its digest; beside, option: of its loss."""
    stated = problem.points.data(*beside)
    source, target, *rest = (array("d", entries.tobytes()) for _, entries in stated)
    model = f"{problem.motion.options} {option}".strip()
    return Clouds(source=source, target=target, weights=sum(rest, array("d")), model=model)


def bounded_clouds(
    problem: RegistrationProblem | Clouds | None, max_residual: Any, objective: str | None = None
) -> Clouds:
    """A problem whose pairs have bounds, as certificates of wrong pairs state it.

    Raises InvalidProblemError for bounds that are none, or where no problem is given.
    """
    if max_residual is None or objective not in {None, *OBJECTIVES}:
        raise InvalidProblemError(
            f"objective is {objective!r}: give 'consensus' or 'truncated', and max_residual",
            array="objective",
            value=objective,
        )
    if problem is None or isinstance(problem, Clouds):
        raise InvalidProblemError(
            "max_residual goes with a problem: give the points that the certificate is about",
            array="max_residual",
        )
    bounds = problem_bounds.checked_bounds(max_residual, problem.n)
    option = OBJECTIVES[objective or "consensus"]
    return _clouds(problem, ("max_residual", bounds), option=option)


def require_accepted(verdict: Verdict) -> None:
    """Nothing if certreg's own certificate was accepted; RefusedCertificateError if not."""
    if not verdict.proved:
        raise RefusedCertificateError(
            f"the checker refused certreg's own certificate: {verdict.words}", verdict=verdict
        )
