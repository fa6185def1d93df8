"""Which page a result has: that of least squares, or of pairs that may be wrong."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from certreg._loading import late
from certreg.report.page import Report
from certreg.report.parts import costed, labelled

if TYPE_CHECKING:
    from certreg.registration.result import Registration
    from certreg.report import consensus_page, truncated_page
    from certreg.report.any_report import AnyReport
    from certreg.report.parts import Labelled

    Reported = Registration | Labelled
else:
    consensus_page = late("certreg.report.consensus_page")
    truncated_page = late("certreg.report.truncated_page")


def report_on(registration: Reported) -> AnyReport[Any]:
    """The report of a registration just made. Raises ValueError where it is not certified."""
    pairs = labelled(registration)
    if pairs is None:
        return Report.of(cast("Registration", registration))
    least = costed(pairs)
    if least is not None:
        return truncated_page.TruncatedReport.of(least)
    return consensus_page.ConsensusReport.of(pairs)


def html_page(report: AnyReport[Any]) -> bytes:
    """The file's content, in UTF-8."""
    return report.html()
