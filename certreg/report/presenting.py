"""Who shows results: what the classes further up ask, see `certreg.results.Shown`.

`certreg/__init__.py` tells them. A result that is to be shown has its line in SHAPES;
a card, in CARDS. Both name classes and functions, and load none: a
process shows results of one type or two.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from certreg._loading import found_late, late
from certreg.errors import InvalidFileError
from certreg.io.atomic import write_atomically
from certreg.verify import shown

if TYPE_CHECKING:
    import os

    from certreg.registration.result import Registration
    from certreg.report import folder as registration_folder
    from certreg.report import pages, plotting
    from certreg.report.encoding import Document
    from certreg.report.pages import Reported
    from certreg.results import Presenter
else:
    pages = late("certreg.report.pages")
    plotting = late("certreg.report.plotting")
    registration_folder = late("certreg.report.folder")


@dataclass(frozen=True, slots=True, kw_only=True)
class Shape:
    """How results of a type are shown: each by a function, `module.name` of this wing."""

    card: str
    words: str
    document: str


SHAPES: dict[str, Shape] = {  # by the name of the type
    "Registration": Shape(
        words="summary.registration_summary",
        document="document.result_document",
        card="cards.registration_card",
    ),
    "ConsensusRegistration": Shape(
        words="pairs.consensus_summary",
        document="pair_fields.pairs_document",
        card="pairs.pairs_card",
    ),
    "TruncatedRegistration": Shape(
        words="pairs.truncated_summary",
        document="pair_fields.pairs_document",
        card="pairs.pairs_card",
    ),
    "Assessment": Shape(
        words="judged_pose.assessment_summary",
        document="judged_pose.assessment_document",
        card="cards.assessment_card",
    ),
    "KeptPairs": Shape(
        words="judged_labels.labels_summary",
        document="judged_labels.labels_document",
        card="judged_labels.labels_card",
    ),
    "TruncatedLabels": Shape(
        words="judged_labels.labels_summary",
        document="judged_labels.truncated_labels_document",
        card="judged_labels.labels_card",
    ),
    "ListedEquilibria": Shape(
        words="listed.enumeration_words",
        document="listed.enumeration_document",
        card="cards.equilibria_card",
    ),
    "EquilibriumSet": Shape(
        words="equilibria.equilibria_words",
        document="document.set_document",
        card="cards.equilibria_card",
    ),
    "ScaledEquilibria": Shape(
        words="breathing.scaled_enumeration_summary",
        document="document.scaled_document",
        card="breathing.scaled_equilibria_card",
    ),
    "SimulatedBreathing": Shape(
        words="simulation.simulation_summary",
        document="simulation.simulation_document",
        card="simulation.simulation_card",
    ),
    "ListedSpringEquilibria": Shape(
        words="listed.spring_enumeration_words",
        document="listed.spring_enumeration_document",
        card="spring_equilibria.spring_equilibria_card",
    ),
    "SpringEquilibria": Shape(
        words="spring_equilibria.spring_equilibria_words",
        document="spring_equilibria.spring_set_document",
        card="spring_equilibria.spring_equilibria_card",
    ),
    "SimulatedSprings": Shape(
        words="simulation.simulation_summary",
        document="simulation.simulation_document",
        card="simulation.simulation_card",
    ),
    "ProblemTrajectory": Shape(
        words="simulation.simulation_summary",
        document="simulation.simulation_document",
        card="simulation.simulation_card",
    ),
}
headline_words = found_late("certreg.registration.headlines", "headline_words")
# A verdict writes its own text and has no document.
CARDS = {
    "CertificateVerdict": "cards.verdict_card",
    **{kind: shape.card for kind, shape in SHAPES.items()},
}


def function(name: str) -> Any:
    """The function of this wing that is called `module.name`."""
    module, _, own = name.partition(".")
    return getattr(import_module(f"certreg.report.{module}"), own)


class ReportPresenter:
    """Shows results by the functions of this wing."""

    def words(self, result: Any) -> str:
        """The text of the command line."""
        return function(SHAPES[type(result).__name__].words)(result)

    def headline(self, result: Registration) -> str:
        """The first line of a registration."""
        return headline_words()(result)

    def document(self, result: Any) -> Document:
        """What `--json` prints."""
        return function(SHAPES[type(result).__name__].document)(result)

    def card(self, result: Any) -> str:
        """HTML for a notebook."""
        return function(CARDS[type(result).__name__])(result)

    def report(self, result: Reported, path: str | os.PathLike[str]) -> Path:
        """Write the page of a registration; where it was written."""
        place = Path(path)
        if result.certificate is None:
            raise InvalidFileError(
                f"{shown(place)}: not written: there is no certificate to report", path=place
            )
        write_atomically(place, pages.html_page(pages.report_on(result)))
        return place

    def save(
        self,
        result: Reported,
        folder: str | os.PathLike[str],
    ) -> Path | None:
        """Write the files of a registration; the certificate's path."""
        return registration_folder.write_folder(result, folder)

    def plot(self, result: Registration, axes: Any) -> Any:
        """Draw a registration into axes of Matplotlib; the axes."""
        return plotting.plotted(result, axes)


PRESENTER: Presenter = ReportPresenter()
