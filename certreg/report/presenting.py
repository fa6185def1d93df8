"""Who shows results: what the classes further up ask, see `certreg.results.Shown`.

`certreg/__init__.py` tells them. A result that is to be shown has its line in SHAPES;
one of which there is only a card, in CARDS.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from certreg.certificate import CertificateVerdict
from certreg.equilibrium import EquilibriumSet
from certreg.errors import InvalidFileError
from certreg.io import write_atomically
from certreg.registration import (
    AnyRegistration,
    Assessment,
    ConsensusRegistration,
    KeptPairs,
    ListedEquilibria,
    ListedSpringEquilibria,
    ProblemTrajectory,
    Registration,
    ScaledConsensusRegistration,
    ScaledEquilibria,
    SimulatedBreathing,
    SimulatedRegistration,
    SimulatedSprings,
    SpringEquilibria,
    SpringRegistration,
    TruncatedLabels,
    TruncatedRegistration,
    proved_end,
)
from certreg.report.breathing import (
    breathing_card,
    breathing_document,
    breathing_summary,
    scaled_enumeration_summary,
    scaled_equilibria_card,
)
from certreg.report.cards import (
    assessment_card,
    equilibria_card,
    registration_card,
    spring_card,
    trajectory_card,
    verdict_card,
)
from certreg.report.consensus_card import consensus_card
from certreg.report.consensus_fields import consensus_document
from certreg.report.consensus_folder import write_wrong_pairs
from certreg.report.consensus_summary import consensus_summary
from certreg.report.document import (
    assessment_document,
    equilibria_document,
    result_document,
    scaled_document,
    set_document,
    simulation_document,
)
from certreg.report.folder import write_folder
from certreg.report.judged_labels import labels_card, labels_document, labels_summary
from certreg.report.judged_pose import assessment_summary
from certreg.report.methods import enumeration_summary
from certreg.report.pages import html_page, report_on
from certreg.report.plotting import plotted
from certreg.report.scaled_summary import registration_summary
from certreg.report.spring_equilibria import (
    spring_enumeration_summary,
    spring_equilibria_card,
    spring_equilibria_document,
    spring_equilibria_words,
    spring_set_document,
)
from certreg.report.spring_simulation import (
    spring_simulation_document,
    spring_simulation_summary,
    spring_trajectory_card,
)
from certreg.report.spring_summary import spring_summary
from certreg.report.summary import (
    equilibria_words,
    simulation_summary,
)
from certreg.report.truncated_fields import truncated_document
from certreg.report.truncated_labels import (
    truncated_labels_card,
    truncated_labels_document,
    truncated_labels_summary,
)
from certreg.report.truncated_summary import truncated_card, truncated_summary
from certreg.verify import shown

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from certreg.report.encoding import Document
    from certreg.report.pages import Reported
    from certreg.results import Presenter


@dataclass(frozen=True, slots=True, kw_only=True)
class Shape:
    """How results of a type are shown."""

    card: Callable[[Any], str]
    words: Callable[[Any], str]
    document: Callable[[Any], Document]


def _simulated(trajectory: ProblemTrajectory) -> SimulatedRegistration:
    return proved_end(trajectory.problem, trajectory.objective, trajectory)


def _trajectory_words(trajectory: ProblemTrajectory) -> str:
    return simulation_summary(_simulated(trajectory))


def _trajectory_document(trajectory: ProblemTrajectory) -> Document:
    return simulation_document(_simulated(trajectory))


def _enumeration_words(listed: ListedEquilibria) -> str:
    return enumeration_summary(listed.enumeration)


def _enumeration_document(listed: ListedEquilibria) -> Document:
    return equilibria_document(listed.enumeration)


def _spring_enumeration_words(listed: ListedSpringEquilibria) -> str:
    return spring_enumeration_summary(listed.enumeration)


def _spring_enumeration_document(listed: ListedSpringEquilibria) -> Document:
    return spring_equilibria_document(listed.enumeration)


SHAPES: dict[type, Shape] = {
    Registration: Shape(
        words=registration_summary, document=result_document, card=registration_card
    ),
    SpringRegistration: Shape(words=spring_summary, document=result_document, card=spring_card),
    ConsensusRegistration: Shape(
        words=consensus_summary, document=consensus_document, card=consensus_card
    ),
    ScaledConsensusRegistration: Shape(
        words=consensus_summary, document=consensus_document, card=consensus_card
    ),
    TruncatedRegistration: Shape(
        words=truncated_summary, document=truncated_document, card=truncated_card
    ),
    Assessment: Shape(words=assessment_summary, document=assessment_document, card=assessment_card),
    KeptPairs: Shape(words=labels_summary, document=labels_document, card=labels_card),
    TruncatedLabels: Shape(
        words=truncated_labels_summary,
        document=truncated_labels_document,
        card=truncated_labels_card,
    ),
    ListedEquilibria: Shape(
        words=_enumeration_words, document=_enumeration_document, card=equilibria_card
    ),
    EquilibriumSet: Shape(words=equilibria_words, document=set_document, card=equilibria_card),
    ScaledEquilibria: Shape(
        words=scaled_enumeration_summary, document=scaled_document, card=scaled_equilibria_card
    ),
    SimulatedBreathing: Shape(
        words=breathing_summary, document=breathing_document, card=breathing_card
    ),
    ListedSpringEquilibria: Shape(
        words=_spring_enumeration_words,
        document=_spring_enumeration_document,
        card=spring_equilibria_card,
    ),
    SpringEquilibria: Shape(
        words=spring_equilibria_words, document=spring_set_document, card=spring_equilibria_card
    ),
    SimulatedSprings: Shape(
        words=spring_simulation_summary,
        document=spring_simulation_document,
        card=spring_trajectory_card,
    ),
    ProblemTrajectory: Shape(
        words=_trajectory_words, document=_trajectory_document, card=trajectory_card
    ),
}
# A verdict writes its own text and has no document.
CARDS = {CertificateVerdict: verdict_card, **{kind: shape.card for kind, shape in SHAPES.items()}}


class ReportPresenter:
    """Shows results by the functions of this wing."""

    def words(self, result: Any) -> str:
        """The text of the command line."""
        return SHAPES[type(result)].words(result)

    def document(self, result: Any) -> Document:
        """What `--json` prints."""
        return SHAPES[type(result)].document(result)

    def card(self, result: Any) -> str:
        """HTML for a notebook."""
        return CARDS[type(result)](result)

    def report(self, result: Reported, path: str | os.PathLike[str]) -> Path:
        """Write the page of a registration; where it was written."""
        place = Path(path)
        if result.certificate is None:
            message = f"{shown(place)}: not written: there is no certificate to report"
            raise InvalidFileError(message, path=place)
        write_atomically(place, html_page(report_on(result)))
        return place

    def save(
        self,
        result: Reported,
        folder: str | os.PathLike[str],
    ) -> Path | None:
        """Write the files of a registration; the certificate's path."""
        if isinstance(result, ConsensusRegistration | TruncatedRegistration):
            return write_wrong_pairs(result, folder)
        return write_folder(result, folder)

    def plot(self, result: AnyRegistration, axes: Any) -> Any:
        """Draw a registration into axes of Matplotlib; the axes."""
        return plotted(result, axes)


PRESENTER: Presenter = ReportPresenter()
