"""What no public name reaches: parts of pages, sentences of a figure alone, sets left in doubt.

The one module of the net that imports modules within certreg.
"""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from answers import answered
from commands import checked
from net_python import bare, lost, page, problem, refused, sentences_of, told, uncertified, whole

from certreg import Registration, SimulationSettings, certify, equilibria
from certreg.equilibrium.presentation import equilibrium_set
from certreg.registration.examples import STORIES, differences, tell
from certreg.report.lines import explained_words
from certreg.report.page import Report
from certreg.report.pages import html_page
from certreg.report.remedies import why_warned
from certreg.report.uncertainty import uncertainty_rows
from certreg.report.words import weak_words

if TYPE_CHECKING:
    from collections.abc import Iterator


def pages() -> str:
    """Pages of what no certificate of ours gives: too little is proved, or a run does not end."""
    proof = whole()
    bounds = checked(proof.bounds)
    loose = replace(proof, bounds=replace(bounds, angle_upper=None))
    weak = replace(Report.of(proof), weak=True)
    hasty = certify(
        problem("cloud", "tilted", damping=0.5),
        simulation=SimulationSettings(step=0.01, max_steps=40),
        relaxation=False,
    )
    return told(
        weak=f"{weak.verdict_words}\n{weak_words(loose)}",
        loose=sentences_of(page(loose)),
        hasty=f"{hasty}\n{sentences_of(page(hasty))}",
        nothing=sentences_of(
            page(replace(proof, bounds=replace(bounds, least_range_squared=Fraction(1, 10**40))))
        ),
        still=sentences_of(
            page(
                replace(
                    proof,
                    solution=replace(proof.solution, trajectory=replace(lost(), reason="not run")),
                )
            )
        ),
        wide=sentences_of(page(bare("axes", "wide"))),
        unproved=refused(lambda: Report.of(uncertified(proof))),
        linked="\n".join(_links(proof)),
    )


def _links(registration: Registration) -> Iterator[str]:
    """Where the theorems of a page lie, if it is in the documentation."""
    report = Report.of(registration, documentation="docs/")
    for line in html_page(report).decode().split("\n"):
        if "docs/" in line and "<a " in line:
            yield line


def doubts() -> str:
    """Sets of which a method leaves something in doubt."""
    listed: Any = equilibria(problem("axes", "turned", damping=2.0), "all")
    found = listed.enumeration
    one = next(each for each in found.searches if each.critical is not None)
    critical = checked(one.critical)
    doubtful = replace(critical, completeness=None, doubt="a path was lost")
    parts = tuple(replace(part, index=None) for part in critical.components)
    wide = replace(critical, components=parts)
    undecided = replace(one, critical=None, reason="homotopy: no list")
    texts = dict[str, str]()
    for name, searches in {
        "doubt": (replace(one, critical=doubtful), undecided),
        "wide": (replace(one, critical=wide), one),
    }.items():
        first = checked(searches[0].critical)
        one_set = equilibrium_set(first, found.objective, 2.0)
        made = replace(found, searches=searches, equilibria=one_set)
        doubted = type(listed)(**made.kept(), enumeration=made)
        document = one_set.to_dict()
        document["equilibria"]["components"] = []
        texts[name] = "\n".join((_untimed(doubted), json.dumps(document)))
        texts[f"{name} card"] = f"{one_set}\n{one_set._repr_html_()}"
    return told(**texts)


def _untimed(listed: Any) -> str:
    document = listed.to_dict()
    roads = [{**one, "time_ms": 0.0} for one in document.get("roads", [])]
    return f"{listed}\n{json.dumps({'roads': roads})}"


def stories() -> str:
    """Where a packaged problem does not come out as told."""
    told_ = tell(STORIES[0])
    other = replace(STORIES[0], told_rmse=(1.0, 2.0, 3.0, 4.0))
    parts = tuple(replace(one, morse_index=3) for one in told_.equilibria.components)
    turned = replace(told_.equilibria, components=parts)
    wrong = replace(answered(told_, equilibria=turned), verdict=None)
    return "\n".join((*differences(STORIES[0], told_), *differences(other, wrong)))


def fits() -> str:
    """How a fit is told where a figure is missing, or at its end."""
    fit = whole().fit
    given = {
        "unknown": replace(fit, explained=None, absent={"explained": lost()}),
        "all": replace(fit, explained=1.0),
        "nearly": replace(fit, explained=1.0 - 1e-12),
        "little": replace(fit, explained=0.0123),
    }
    lines = [f"{name}: {explained_words(one)}" for name, one in given.items()]
    for source, target, sigma in (
        ("line", "bent", None),
        ("one", "other", 0.5),
        ("flat", "flat", 1e-3),
        ("cloud", "noisier", 0.02),
        ("cloud", "outlier", 1e-3),
        ("huge", "huge", 1.0),
        ("many", "manymoved", None),
        ("axes", "wide", None),
        ("13-source", "13-target", 1.0),
        ("axes", "huger", 1.0),
        ("axes", "axes", 1e-6),
    ):
        stated = problem(source, target, sigma=sigma)
        found = certify(stated, relaxation=False, simulation=False)
        lines.append(f"{source} {target} {sigma}: {uncertainty_rows(found)}")
        lines += [f"  {one.code.value}: {one.text}" for one in found.fit.warnings]
        lines += [f"  {found.fit.worst[:2]} {found.fit.chi2} {found.fit.scale_p}"]
    return "\n".join(lines)


def spoken_of_warnings(fit: Any) -> list[str]:
    """What is said first of each kind of warning, where the fit explains little, or much."""
    poor = certify(problem("cloud", "outlier"), relaxation=False, simulation=False).fit.warnings[0]
    return [
        why_warned(
            replace(
                fit, explained=explained, warnings=(replace(poor, code=code, text="", remedy=""),)
            )
        )
        for code in type(poor.code)
        for explained in (0.499, 0.5)
    ]


STEPS = {"pages": pages, "doubts": doubts, "stories": stories, "fits": fits}
