"""Which page a result has: that of least squares, or of pairs that may be wrong."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from certreg._loading import late
from certreg.report.page import Report
from certreg.report.parts import labelled

if TYPE_CHECKING:
    from certreg.registration.labelled import LabelledRegistration
    from certreg.registration.result import Registration
    from certreg.report import pair_page
    from certreg.report.any_report import AnyReport

    Reported = Registration | LabelledRegistration
else:
    pair_page = late("certreg.report.pair_page")


def report_on(registration: Reported) -> AnyReport[Any]:
    """The report of a registration just made. Raises ValueError where it is not certified."""
    pairs = labelled(registration)
    if pairs is None:
        return Report.of(cast("Registration", registration))
    return pair_page.PairsReport.of(pairs)


def html_page(report: AnyReport[Any]) -> bytes:
    """The file's content, in UTF-8."""
    return report.html()
