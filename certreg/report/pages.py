"""Which page a registration has: by its pairs, its springs, and how the source may move."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from certreg.registration import (
    ConsensusRegistration,
    SpringRegistration,
    TruncatedRegistration,
)
from certreg.report.consensus_page import ConsensusReport
from certreg.report.page import Report
from certreg.report.similarity_page import SimilarityReport
from certreg.report.spring_page import SpringReport
from certreg.report.truncated_page import TruncatedReport

if TYPE_CHECKING:
    from certreg.problem import RegistrationProblem
    from certreg.registration import AnyRegistration, Registration
    from certreg.report.any_report import AnyReport

    Reported = AnyRegistration | ConsensusRegistration | TruncatedRegistration


def report_on(registration: Reported) -> AnyReport[Any]:
    """The report of a registration just made. Raises ValueError where it is not certified."""
    if isinstance(registration, ConsensusRegistration):
        return ConsensusReport.of(registration)
    if isinstance(registration, TruncatedRegistration):
        return TruncatedReport.of(registration)
    if isinstance(registration, SpringRegistration):
        return SpringReport.of(registration)
    kind = page_of(registration.problem)
    return kind.of(cast("Registration", registration))


def page_of(problem: RegistrationProblem) -> type[Report]:
    """Which page a problem with one weight for each pair has: by how its source may move."""
    return SimilarityReport if problem.model_options else Report


def html_page(report: AnyReport[Any]) -> bytes:
    """The file's content, in UTF-8."""
    return report.html()
