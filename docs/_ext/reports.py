"""`{reports}` writes certreg's own reports while the page is built, and a table that leads to them.

Beside each link stands a small picture of the registration.

Each line of its content names an example and says what to look at; every example must be named. The
reports lie in `gallery/` beside the pages, so that their theorems lead to the pages of the proofs.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from docutils import nodes
from sphinx.errors import ExtensionError
from sphinx.util.docutils import SphinxDirective

from certreg.problem.problem import RegistrationProblem
from certreg.registration.certification import certify
from certreg.registration.examples import STORIES, tell
from certreg.report.markup import rendered
from certreg.report.page import Report
from certreg.report.pages import html_page
from certreg.report.pair_page import PairsReport
from certreg.report.picture import registration_picture

if TYPE_CHECKING:
    from collections.abc import Sequence

    from sphinx.application import Sphinx
    from sphinx.util.typing import ExtensionMetadata

    from certreg.registration.labelled import ConsensusRegistration, TruncatedRegistration
    from certreg.registration.result import Registration
    from certreg.report.any_report import AnyReport

PICTURE = "report/templates/picture.html"
FOLDER = "gallery"  # beside the page, in the built documentation


@dataclass(frozen=True)
class Example:
    """A problem of exact coordinates that shows one row of the classification."""

    source: list[list[float]]
    target: list[list[float]]

    def register(self) -> Registration:
        """The certified registration."""
        problem = RegistrationProblem(self.source, self.target)
        return certify(problem, relaxation=False, about={"source": "source", "target": "target"})


SQUARE = [[1.0, 1, 0], [1, -1, 0], [-1, -1, 0], [-1, 1, 0]]
TETRAHEDRON = [[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]
TALL = [[1.0, 1, 2], [1, -1, -2], [-1, 1, -2], [-1, -1, 2]]
LINE = [[0.0, 0, 0], [1, 2, 3], [2, 4, 6], [5, 10, 15]]
BENT = [[0.0, 0, 0], [1, 2, 3], [2, 4, 7], [5, 9, 15]]
OCTAHEDRON = [[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]


def quarter(points: list[list[float]]) -> list[list[float]]:
    """The points after a quarter turn about z."""
    return [[-y, x, z] for x, y, z in points]


def mirrored(points: list[list[float]]) -> list[list[float]]:
    """The points with x reversed."""
    return [[-x, y, z] for x, y, z in points]


EXAMPLES = {
    "square": Example(SQUARE, quarter(SQUARE)),
    "tall": Example(TALL, quarter(TALL)),
    "tetrahedron": Example(TETRAHEDRON, quarter(TETRAHEDRON)),
    "mirrored-tall": Example(TALL, mirrored(TALL)),
    "mirrored-tetrahedron": Example(TETRAHEDRON, mirrored(TETRAHEDRON)),
    "line": Example(BENT, LINE),
    "nothing": Example(OCTAHEDRON, [[abs(x), abs(y), abs(z)] for x, y, z in OCTAHEDRON]),
}


def wrong_pairs(
    *, second: bool = False, size: float = 1.0, scale: str = "none"
) -> ConsensusRegistration:
    """Twenty pairs of which eight are wrong; or of which ten have moved on their own.

    size: of the source, which a free scale has to make good for.
    """
    random = np.random.default_rng(7)
    source = random.uniform(size=(20, 3))
    target = source[:, [1, 2, 0]] + random.uniform(-0.005, 0.005, (20, 3))
    if second:
        target[10:] = source[10:] + np.array([0.3, -0.2, 0.4])
    else:
        target[12:] = random.uniform(-0.3, 1.3, (8, 3))
    about = {"source": "source", "target": "target"}
    result = certify(size * source, target, max_residual=0.03, scale=scale, about=about)
    return cast("ConsensusRegistration", result)


def stars() -> TruncatedRegistration:
    """Thirty directions, seen turned; ten are taken for others."""
    random = np.random.default_rng(3)
    source = random.standard_normal((30, 3))
    source /= np.linalg.norm(source, axis=1)[:, np.newaxis]
    target = source[:, [1, 2, 0]] + random.uniform(-0.01, 0.01, (30, 3))
    target[20:] = np.roll(target[20:], 3, axis=0)
    model = {"rotation_only": True, "objective": "truncated", "max_residual": 0.05}
    about = {"source": "catalogue", "target": "seen"}
    return cast("TruncatedRegistration", certify(source, target, about=about, **model))


WRONG = {
    "wrong-pairs": wrong_pairs,
    "stars": stars,
    "unknown-scale": lambda: wrong_pairs(size=0.4, scale="asymmetric"),
    "two-bodies": lambda: wrong_pairs(second=True),
}


class Reports(SphinxDirective):
    """Reports and a table of them: the report with a picture, what to look at, multiplicities."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """Write the reports and show the table."""
        told = dict(line.split(": ", 1) for line in self.content if line.strip())
        registrations = {story.name: lambda story=story: tell(story) for story in STORIES}
        registrations |= {name: example.register for name, example in EXAMPLES.items()}
        if told.keys() != {*registrations, *WRONG}:
            missed = ", ".join(sorted(told.keys() ^ {*registrations, *WRONG}))
            raise ExtensionError(
                f"{self.env.docname}: reports that are not on both lists: {missed}"
            )
        body = nodes.tbody()
        for name, words in told.items():
            link = nodes.reference("", name.replace("-", " "), refuri=f"{FOLDER}/{name}.html")
            inlines, _ = self.state.inline_text(words, self.lineno)
            if name in WRONG:
                result = WRONG[name]()
                self.write(name, PairsReport.of(result, documentation="../"))
                drawn, further = result.fit, f" {result.headline}"
            else:
                drawn = registrations[name]()
                self.write(name, Report.of(drawn, documentation="../"))
                pattern = ", ".join(map(str, drawn.equilibria.classification.pattern))
                further = f" Multiplicities {pattern}."
            picture = rendered(PICTURE, picture=registration_picture(drawn))
            small = nodes.raw("", picture, format="html")
            body += row([link, small], [*inlines, nodes.Text(further)])
        titles = ("report", "what to look at")
        head = nodes.thead("", row(*([nodes.Text(words)] for words in titles)))
        widths = [nodes.colspec(colwidth=width) for width in (30, 70)]
        table = nodes.tgroup("", *widths, head, body, cols=2)
        return [nodes.table("", table, classes=["gallery"])]

    def write(self, name: str, report: AnyReport[Any]) -> None:
        """Write a report whose theorems lead to the pages of the proofs."""
        folder = Path(self.env.app.outdir) / FOLDER
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{name}.html").write_bytes(html_page(report))


def row(*cells: Sequence[nodes.Node]) -> nodes.row:
    """A row of a table."""
    return nodes.row("", *(nodes.entry("", nodes.paragraph("", "", *cell)) for cell in cells))


def setup(app: Sphinx) -> ExtensionMetadata:
    """Called by Sphinx."""
    app.add_directive("reports", Reports)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
