"""Which page a result has: that of least squares, or of pairs that may be wrong."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from certreg import registration as made  # whose other kinds of results most pages do without
from certreg._loading import late
from certreg.registration import AnyRegistration
from certreg.report.page import Report

if TYPE_CHECKING:
    from certreg.registration import ConsensusRegistration, TruncatedRegistration
    from certreg.report import consensus_page, truncated_page
    from certreg.report.any_report import AnyReport

    Reported = AnyRegistration | ConsensusRegistration | TruncatedRegistration
else:
    consensus_page = late("certreg.report.consensus_page")
    truncated_page = late("certreg.report.truncated_page")


def report_on(registration: Reported) -> AnyReport[Any]:
    """The report of a registration just made. Raises ValueError where it is not certified."""
    if isinstance(registration, AnyRegistration):
        return Report.of(registration)
    if isinstance(registration, made.TruncatedRegistration):
        return truncated_page.TruncatedReport.of(registration)
    return consensus_page.ConsensusReport.of(registration)


def html_page(report: AnyReport[Any]) -> bytes:
    """The file's content, in UTF-8."""
    return report.html()
