"""Which page a registration has: by its springs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from certreg.errors import InvalidProblemError
from certreg.registration import SpringRegistration
from certreg.report.page import Report
from certreg.report.spring_page import SpringReport

if TYPE_CHECKING:
    from certreg.registration import AnyRegistration, Registration
    from certreg.report.any_report import AnyReport


def report_on(registration: AnyRegistration) -> AnyReport[Any]:
    """The report of a registration just made. Raises ValueError where it is not certified.

    Raises InvalidProblemError for a free scale, and without a translation: it draws rigid motions.
    """
    if registration.problem.model_options:
        message = f"no report is drawn with {registration.problem.model_options}: print the result"
        raise InvalidProblemError(message, array="problem")
    if isinstance(registration, SpringRegistration):
        return SpringReport.of(registration)
    return Report.of(cast("Registration", registration))


def html_page(report: AnyReport[Any]) -> bytes:
    """The file's content, in UTF-8."""
    return report.html()
