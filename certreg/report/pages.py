"""Which page a registration has: by its pairs, its springs, and how the source may move."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from certreg._loading import late
from certreg.objective.structure import Structure
from certreg.registration.result import Registration
from certreg.report.page import Report

if TYPE_CHECKING:
    from certreg.problem.problem import RegistrationProblem
    from certreg.registration import truncated
    from certreg.registration.consensus import ConsensusRegistration
    from certreg.registration.truncated import TruncatedRegistration
    from certreg.report import consensus_page, similarity_page, spring_page, truncated_page
    from certreg.report.any_report import AnyReport

    Reported = Registration | ConsensusRegistration | TruncatedRegistration
else:
    consensus_page = late("certreg.report.consensus_page")
    similarity_page = late("certreg.report.similarity_page")
    spring_page = late("certreg.report.spring_page")
    truncated_page = late("certreg.report.truncated_page")
    # most pages do without
    truncated = late("certreg.registration.truncated")


def report_on(registration: Reported) -> AnyReport[Any]:
    """The report of a registration just made. Raises ValueError where it is not certified."""
    if isinstance(registration, Registration):
        if registration.structure is Structure.QUARTIC:
            return spring_page.SpringReport.of(registration)
        return page_of(registration.problem).of(registration)
    if isinstance(registration, truncated.TruncatedRegistration):
        return truncated_page.TruncatedReport.of(registration)
    return consensus_page.ConsensusReport.of(registration)


def page_of(problem: RegistrationProblem) -> type[Report]:
    """Which page a problem with one weight for each pair has: by how its source may move."""
    return similarity_page.SimilarityReport if problem.motion.options else Report


def html_page(report: AnyReport[Any]) -> bytes:
    """The file's content, in UTF-8."""
    return report.html()
