"""The report: one HTML file that shows a registration and its proof, and asks no other host."""

from __future__ import annotations

import base64
import hashlib
import shlex
from dataclasses import dataclass
from importlib.resources import files
from typing import TYPE_CHECKING

from certreg import __version__
from certreg.registration import WEAK, at_most, headline_of, share_words
from certreg.report.markup import (
    Markup,
    asset_block,
    data_block,
    element,
    json_block,
    printable,
)
from certreg.report.summary import margin_words, number, verdict_words, warnings
from certreg.report.viewer import Names, packed, sample_of, scene_document, viewer_section
from certreg.report.words import (
    NOT_CLAIMED,
    THEOREMS,
    MethodAngles,
    Sentence,
    motion_words,
    sentences,
    trap_words,
    weak_words,
)
from certreg.results import Limits, Optimality

if TYPE_CHECKING:
    from collections.abc import Iterator

    from certreg.certificate import Certificate, IsotropicBody
    from certreg.registration import Headline, Registration
    from certreg.results import Verdict

ASSETS = files("certreg.report") / "assets"
GUARANTEE_WORDS = (
    "Exact: integer arithmetic and a theorem. Numerical: computed with rounding that nobody has "
    "bounded. Each theorem has a page in the documentation; certreg derive NAME proves it anew."
)
EMBEDDED_BYTES = 8 << 20  # of a certificate in its page; a larger one is named there
CHECKERS = ("certreg verify", "python3 -I -S verify.py")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Report:
    """What a page shows.

    content: the bytes of the certificate's file, name: what it is called. verdict: the checker's,
    on these; the registration's bounds are those that it proves. weak: they are far from what can
    be proved. documentation: where its pages lie, to link to.
    """

    registration: Registration
    certificate: Certificate[IsotropicBody]
    content: bytes
    verdict: Verdict
    name: str = "certificate.json"
    weak: bool = False
    documentation: str | None = None

    @classmethod
    def of(cls, registration: Registration, *, documentation: str | None = None) -> Report:
        """The report of a registration just made. Raises ValueError where it is not certified."""
        certificate, verdict = registration.certificate, registration.verdict
        if certificate is None or verdict is None:
            message = "the registration is not certified: there is no certificate to report"
            raise ValueError(message)
        return cls(
            registration=registration,
            certificate=certificate,
            content=certificate.to_json(),
            verdict=verdict,
            documentation=documentation,
        )

    @property
    def embedded(self) -> bool:
        """Whether the page carries the certificate; a large one it only names."""
        return len(self.content) <= EMBEDDED_BYTES

    @property
    def verdict_words(self) -> list[str]:
        """What this certificate proves of the pose: a headline, then what else comes first."""
        headline, *further = verdict_words(self.registration)
        if self.headline is WEAK:
            headline = WEAK.said()
        return [headline, *([weak_words(self.registration)] if self.weak else []), *further]

    @property
    def headline(self) -> Headline:
        """Which headline the page has: that of a weak certificate is no better than it is."""
        if self.weak and self.registration.status is not Optimality.BOUNDED:
            return WEAK
        return headline_of(self.registration)


def html_page(report: Report) -> bytes:
    """The file's content, in UTF-8."""
    names = Names.of(report.certificate.about, report.registration.problem.n)
    style, script = ((ASSETS / name).read_text("utf-8") for name in ("report.css", "report.js"))
    head = (
        element("meta", charset="utf-8"),
        element("meta", http_equiv="Content-Security-Policy", content=_policy(style, script)),
        element("meta", name="viewport", content="width=device-width, initial-scale=1"),
        element("meta", name="color-scheme", content="light dark"),
        element("meta", name="generator", content=f"certreg {__version__}"),
        element("title", f"{_stamp(report)}: {names.source} to {names.target}"),
        asset_block("style", style),
    )
    body = (
        _header(report, names),
        element("main", *_sections(report)),
        _footer(),
        *_blocks(report, names),
        asset_block("script", script),
    )
    whole = element("html", element("head", *head), element("body", *body), lang="en")
    return f"<!doctype html>\n{whole}\n".encode()


def _policy(style: str, script: str) -> str:
    """Nothing is loaded from anywhere; only these two texts are style and script."""
    hashes = [base64.b64encode(hashlib.sha256(t.encode()).digest()) for t in (style, script)]
    styles, scripts = (f"'sha256-{digest.decode('ascii')}'" for digest in hashes)
    return (
        f"default-src 'none'; style-src {styles}; script-src {scripts}; img-src data:; "
        "base-uri 'none'; form-action 'none'"
    )


def _blocks(report: Report, names: Names) -> Iterator[Markup]:
    problem = report.registration.problem
    document = scene_document(report.registration, names)
    yield json_block("scene", document)
    if report.embedded:
        yield data_block("certificate", "text/plain", packed(report.content))
    if report.certificate.data is None or not report.embedded:
        yield data_block("sample", "text/plain", sample_of(problem))


def _stamp(report: Report) -> str:
    return report.verdict_words[0].partition(": ")[0].capitalize()


def _header(report: Report, names: Names) -> Markup:
    registration = report.registration
    headline, *further = report.verdict_words
    stamp, _, said = headline.partition(": ")
    kind = "good" if report.headline.good and _within_usual(registration) else "open"
    n, trap = registration.problem.n, trap_words(registration.equilibria)
    noted = warnings(registration, headline)
    return element(
        "header",
        element(
            "p",
            element("bdi", names.source),
            " → ",
            element("bdi", names.target),
            f" · {n} pair{'s' * (n != 1)}",
            class_="files",
        ),
        element("p", stamp, class_=f"stamp {kind}"),
        element("h1", _begun(said)),
        *(element("p", _begun(words), class_="lead") for words in further),
        *(element("p", _begun(words), class_="warning") for words in noted),
        element("p", motion_words(registration), class_="lead"),
        *([] if trap is None else [element("p", trap, class_="lead")]),
        element("dl", *_facts(registration), class_="facts"),
    )


def _within_usual(registration: Registration) -> bool:
    """Whether what is proved is within the usual limits, whatever limits were asked for."""
    bounds = registration.bounds
    return bounds is not None and bounds.meet(Limits(), unique=True)


def _begun(words: str) -> str:
    return words[:1].upper() + words[1:]


def _facts(registration: Registration) -> Iterator[Markup]:
    """The figures that one asks for first."""
    equilibria, bounds = registration.equilibria, registration.bounds
    others = equilibria.classification.spurious
    counted = "infinitely many" if others is None else str(others)
    facts = [("RMSE", number(registration.rmse), "of the pairs, in the unit of the clouds")]
    if bounds is not None:
        gap = at_most(bounds.greatest_gap)
        words = f"of the objective above the global minimum: {share_words(bounds)}"
        facts.append(("Proved gap", f"≤ {gap}", words))
    facts += [
        ("Wrong poses at rest", counted, "where the springs balance and the fit is not the best"),
        ("Ambiguity margin", *_split(margin_words(equilibria))),
    ]
    for name, value, words in facts:
        yield element(
            "div", element("dt", name), element("dd", value), element("dd", words, class_="note")
        )


def _split(words: str) -> tuple[str, str]:
    value, _, rest = words.partition(": ")
    figure, percent, unit = value.partition(" % ")
    return (f"{figure}{' %' if percent else ''}", f"{unit}{': ' if unit else ''}{rest}")


def _sections(report: Report) -> Iterator[Markup]:
    yield _section("see", "See it", viewer_section(report.registration))
    yield _section("charts", "In numbers", *_charts())
    angles = MethodAngles.of(report.registration.solution.agreement)
    known = sentences(report.registration, report.certificate.body, angles)
    yield _section(
        "proof",
        "What is proved, and how we know",
        element("p", GUARANTEE_WORDS, class_="note"),
        element("ol", *(_sentence(one, report.documentation) for one in known), class_="known"),
        element("h3", "Not claimed"),
        element("ul", *(element("li", words) for words in NOT_CLAIMED)),
    )
    yield _section("check", "Check it yourself", *_check(report))
    yield _section("pose", "The pose", *_pose(report.registration))


def _section(name: str, title: str, *content: Markup) -> Markup:
    heading = element("h2", title, id=f"{name}-title")
    return element("section", heading, *content, id=name, aria_labelledby=f"{name}-title")


def _charts() -> Iterator[Markup]:
    charts = (
        ("energy", "Energy along the motion", "Dashed: the poses at rest (index)."),
        ("spectrum", "Eigenvalues at this pose at rest", "Right of the line: a push grows."),
        ("residuals", "Distances of the pairs", "At the pose shown, the worst first."),
        ("margin", "Ambiguity margin", "How far the data are from a second best pose."),
    )
    for name, title, words in charts:
        caption = element("figcaption", element("b", title), " ", element("span", words))
        yield element("figure", caption, element("div", class_="chart"), id=name)


def _sentence(known: Sentence, documentation: str | None) -> Markup:
    label = known.guarantee.label
    rests = [_theorem(name, documentation) for name in known.theorems]
    how = element("p", element("span", label, class_=f"how {label}"), *rests, class_="rests-on")
    return element("li", element("p", known.words), how)


def _theorem(name: str, documentation: str | None) -> Markup:
    """A theorem by its title: a link to its page, or the name by which it is found and proved."""
    title = THEOREMS[name]
    if documentation is not None:
        return element("a", title, href=f"{documentation}proofs/{name}.html")
    return element("span", f"{title} (", element("code", name), ")")


def _embedded() -> Iterator[Markup]:
    yield element(
        "p",
        "The certificate is in this file. Save it, and let it be checked in exact integer "
        "arithmetic, with certreg or with nothing but Python:",
    )
    yield element(
        "p",
        element("button", "Save certificate.json", id="save", type="button"),
        element("span", id="saved", role="status"),
    )


def _named(report: Report) -> Iterator[Markup]:
    size, limit = (count / 2**20 for count in (len(report.content), EMBEDDED_BYTES))
    yield element(
        "p",
        f"The certificate is too large for a page: {size:.1f} MiB, more than {limit:.0f}. It is "
        "the file ",
        element("bdi", printable(report.name)),
        " that was written or given with this page, and has the SHA-256 below. Let it be checked "
        "in exact integer arithmetic, with certreg or with nothing but Python:",
    )
    digest = hashlib.sha256(report.content).hexdigest()
    yield element("p", "SHA-256 of the certificate: ", element("code", digest, id="file-digest"))


def _check(report: Report) -> Iterator[Markup]:
    name = "certificate.json" if report.embedded else shlex.quote(printable(report.name))
    yield from _embedded() if report.embedded else _named(report)
    yield element("pre", element("code", "\n".join(f"{c} {name}" for c in CHECKERS)))
    digest = report.registration.problem.digest()
    yield element("p", "SHA-256 of the points and weights: ", element("code", digest, id="digest"))
    lines = "\n".join((*report.verdict.theorems, "VERIFIED"))
    yield element(
        "details",
        element("summary", "What the checker said when this page was written"),
        element("pre", lines, tabindex=0),
    )


def _pose(registration: Registration) -> Iterator[Markup]:
    pose = registration.pose
    rows = [" ".join(map(repr, row)) for row in pose.T_target_source.tolist()]
    yield element("p", "The 4×4 matrix that takes source coordinates to target coordinates:")
    yield element("pre", "\n".join(rows), tabindex=0, aria_label="4 by 4 matrix")
    quaternion = " ".join(map(repr, pose.quaternion_wxyz.tolist()))
    yield element(
        "p",
        "Rotation as a unit quaternion, w x y z; the bounds hold for this one, with the "
        "translation of the matrix:",
    )
    yield element("pre", quaternion, tabindex=0, aria_label="quaternion")


def _footer() -> Markup:
    return element(
        "footer",
        element(
            "p",
            f"Written by certreg {__version__}. This file is complete: it loads nothing and sends "
            "nothing. The scene is drawn by three.js (MIT licence, in the script).",
        ),
    )
