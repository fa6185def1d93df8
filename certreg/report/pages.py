"""Which page a registration has: by its springs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from certreg.registration import SpringRegistration
from certreg.report.page import Report
from certreg.report.spring_page import SpringReport

if TYPE_CHECKING:
    from certreg.registration import AnyRegistration, Registration
    from certreg.report.any_report import AnyReport


def report_on(registration: AnyRegistration) -> AnyReport[Any]:
    """The report of a registration just made. Raises ValueError where it is not certified."""
    if isinstance(registration, SpringRegistration):
        return SpringReport.of(registration)
    return Report.of(cast("Registration", registration))


def html_page(report: AnyReport[Any]) -> bytes:
    """The file's content, in UTF-8."""
    return report.html()
