"""Who shows results: what the classes further up ask, see `certreg.results.Shown`.

`certreg/__init__.py` tells them. A result that is to be shown has its line in SHAPES, whose classes
and functions are loaded when they are called for: a process shows results of one type or two.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from certreg._loading import found_late, late
from certreg.errors import InvalidFileError
from certreg.io.atomic import write_atomically
from certreg.verify import shown

if TYPE_CHECKING:
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


Function = Callable[[], Callable[[Any], Any]]  # loaded when it is first called for


@dataclass(frozen=True, slots=True, kw_only=True)
class Shape:
    """How results of a class are shown: each by a function of this wing.

    words, document: None of a verdict, which writes its own text and has no document.
    """

    of: Callable[[], type]
    card: Function
    words: Any = None
    document: Any = None

    @classmethod
    def told(cls, of: Callable[[], type], told: Function) -> Shape:
        """By what tells all of it; told: makes that of a result."""

        def shown(by: Callable[[Any], Any]) -> Function:
            return lambda: lambda result: by(told()(result))

        return cls(
            of=of,
            words=shown(lambda one: one.words()),
            document=shown(lambda one: one.document()),
            card=shown(lambda one: one.card()),
        )


def _of(module: str, name: str) -> Callable[[], Any]:
    return found_late(f"certreg.registration.{module}", name)


def _by(module: str, name: str) -> Function:
    return found_late(f"certreg.report.{module}", name)


headline_words = _of("headlines", "headline_words")
SHAPES = (  # the light ones first: classes are loaded up to that of the result
    Shape(
        of=_of("result", "Registration"),
        words=_by("summary", "registration_summary"),
        document=_by("document", "result_document"),
        card=_by("cards", "registration_card"),
    ),
    Shape(
        of=found_late("certreg.certificate.checking", "CertificateVerdict"),
        card=_by("cards", "verdict_card"),
    ),
    Shape.told(_of("simulation", "SimulatedMotion"), _by("simulation", "told_motion")),
    Shape.told(_of("enumeration", "ListedEquilibria"), _by("equilibria", "listed_rests")),
    Shape.told(
        found_late("certreg.equilibrium.equilibrium_set", "EquilibriumSet"),
        _by("equilibria", "rigid_rests"),
    ),
    Shape.told(_of("equilibria", "ScaledEquilibria"), _by("equilibria", "scaled_rests")),
    Shape.told(_of("equilibria", "SpringEquilibria"), _by("equilibria", "spring_rests")),
    Shape(
        of=_of("assessed", "Assessment"),
        words=_by("judged_pose", "assessment_summary"),
        document=_by("judged_pose", "assessment_document"),
        card=_by("cards", "assessment_card"),
    ),
    Shape(
        of=_of("labelled", "LabelledRegistration"),
        words=_by("pairs", "pairs_summary"),
        document=_by("pair_fields", "pairs_document"),
        card=_by("pairs", "pairs_card"),
    ),
    *(
        Shape(
            of=_of("label_assessment", name),
            words=_by("judged_labels", "labels_summary"),
            document=_by("judged_labels", document),
            card=_by("judged_labels", "labels_card"),
        )
        for name, document in (
            ("KeptPairs", "labels_document"),
            ("TruncatedLabels", "truncated_labels_document"),
        )
    ),
)


def shape_of(result: Any) -> Shape:
    """How a result is shown."""
    return next(shape for shape in SHAPES if isinstance(result, shape.of()))


class ReportPresenter:
    """Shows results by the functions of this wing."""

    def words(self, result: Any) -> str:
        """The text of the command line."""
        return shape_of(result).words()(result)

    def headline(self, result: Registration) -> str:
        """The first line of a registration."""
        return headline_words()(result)

    def document(self, result: Any) -> Document:
        """What `--json` prints."""
        return shape_of(result).document()(result)

    def card(self, result: Any) -> str:
        """HTML for a notebook."""
        return shape_of(result).card()(result)

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
