"""Every field of a document is the number of its name, in its unit; a page has all its parts."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from fractions import Fraction
from html.parser import HTMLParser
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import checked
from strategies import random_problem

from certreg.exact.dyadic import double_below
from certreg.registration import headlines as listed
from certreg.registration.certification import certify
from certreg.registration.covariance import worst_residuals
from certreg.registration.enumeration import enumerated
from certreg.registration.headlines import headline_of, is_green
from certreg.registration.simulation import SimulatedRegistration
from certreg.report.any_report import EMBEDDED_BYTES
from certreg.report.document import dumps, result_document
from certreg.report.methods import methods_fields, methods_summary, methods_table, road_fields
from certreg.report.overview import split
from certreg.report.page import Report
from certreg.report.pages import html_page
from certreg.report.simulation import ended
from certreg.report.summary import registration_summary
from certreg.results import OUT_OF_RANGE, Absent, Limits, Optimality

if TYPE_CHECKING:
    from certreg.registration.enumeration import Enumeration
    from certreg.registration.result import Registration


PROBLEM = random_problem(np.random.default_rng(9), n=12, noise=0.2, decades=1.0)


def leaves(value: Any, path: str = "") -> dict[str, Any]:
    """All values of a document, by their paths."""
    if isinstance(value, dict):
        return {k: v for key, one in value.items() for k, v in leaves(one, f"{path}.{key}").items()}
    if isinstance(value, list) and value:
        return {k: v for i, one in enumerate(value) for k, v in leaves(one, f"{path}[{i}]").items()}
    return {path.removeprefix("."): value}


@pytest.fixture(scope="module")
def registration() -> Registration:
    return certify(PROBLEM)


def test_every_field_of_a_result_is_the_number_of_its_name(registration: Registration):
    solution, pose, fit = registration.solution, registration.pose, registration.fit
    relaxed: Any = solution.relaxation
    run: Any = solution.trajectory
    bounds, claims = checked(registration.bounds), checked(registration.certificate).body.claims
    radius = checked(checked(registration.certificate).body.radius)
    covariance, equilibria = checked(solution.covariance), registration.equilibria
    ends = [Fraction(float(e)) for e in (run.potential + run.kinetic)[[0, -1]]]
    told = result_document(registration, "a path", notes=["as read"])
    expected: dict[str, Any] = {
        "schema": "certreg-result/1",
        "n": 12,
        "damping": solution.problem.damping,
        "pose": {
            "rotation": pose.rotation.tolist(),
            "translation": pose.translation.tolist(),
            "quaternion_wxyz": pose.quaternion_wxyz.tolist(),
            "scale": None,
            "scale_interval": None,
            "covariance": np.asarray(covariance).tolist(),
            "covariance_scale": "estimated",
            "variance_factor": covariance.variance_factor,
            "uncertainty": {
                "translation": covariance.translation_sigma.tolist(),
                "rotation_deg": np.degrees(covariance.rotation_sigma).tolist(),
                "centre": covariance.centre_sigma,
                "loosest_turn": {
                    "sigma_deg": math.degrees(covariance.loosest_sigma),
                    "axis": covariance.loosest_axis.tolist(),
                },
                "degrees_of_freedom": 30,
            },
        },
        "objective": registration.objective,
        "rmse": registration.rmse,
        "optimality": {
            "status": "certified",
            "gap_bound": bounds.gap_upper,
            "gap_share": bounds.share_upper,
            "angle_bound_rad": bounds.angle_upper,
            "limits": {"gap_share": Limits().max_gap, "angle_rad": Limits().max_angle},
            "unique": True,
            "method": "spectral",
            "growth": None,
        },
        "springs": None,
        "consensus": None,
        "margin": {
            "eigenvalue_gap": equilibria.margin.eigenvalue_gap,
            "relative": equilibria.margin.relative,
            "nearly_ambiguous": False,
            "hardly_determined": False,
        },
        "robustness": {
            "angle_deg": 5.0,
            "radius_target": double_below(radius.target.value),
            "radius_both": double_below(radius.both.value),
        },
        "relaxation": {
            "solver": relaxed.solver.split(" ")[0].upper(),
            "form": relaxed.form.value,
            "status": relaxed.solver_word,
            "value": float(Fraction(relaxed.value) * relaxed.unit),
            "rank": 1,
            "angle_to_pose_deg": math.degrees(checked(solution.agreement.relaxation)),
        },
        "simulation": {
            "integrator": "splitting",
            "status": run.status.value,
            "step": run.step,
            "steps": run.steps,
            "converged": True,
            "in_certified_basin": claims.basin,
            "escapes": run.escapes,
            "residual": run.speed,
            "predicted_rate": run.stated("predicted_rate"),
            "decay_rate": run.stated("decay_rate"),
            "angle_to_pose_deg": math.degrees(checked(solution.agreement.simulation)),
            "energy": dict(
                zip(
                    ("initial", "final"),
                    (float(e * solution.energy_unit) for e in ends),
                    strict=True,
                )
            ),
        },
        "agreement": {
            "closed_form_deg": math.degrees(solution.agreement.closed_form),
            "relaxation_deg": math.degrees(checked(solution.agreement.relaxation)),
            "simulation_deg": math.degrees(checked(solution.agreement.simulation)),
        },
        "fit": {
            "explained": fit.explained,
            "best_scale": fit.best_scale,
            "scale_p": fit.scale_p,
            "largest_over_median_residual": fit.largest_over_median_residual,
            "worst": [{"row": one.row, "residual": one.residual} for one in fit.worst],
            "chi2": None,
            "warnings": [],
        },
        "residuals": [
            {"row": one.row, "distance": one.distance} for one in worst_residuals(PROBLEM, pose, 10)
        ],
        "certificate": "a path",
        "digest": PROBLEM.digest(),
        "notes": ["as read"],
        "theorems": list(checked(registration.verdict).theorems),
        "timings_ms": {name: 1000 * value for name, value in registration.timings.items()},
    }
    given = leaves(told)
    wanted = {k: None if isinstance(v, Absent) else v for k, v in leaves(expected).items()}
    own = ("equilibria.", "reasons.", "bounds_hold_for", "relaxation.proved_gap")

    assert {k: given.get(k) for k in wanted} == wanted
    assert {k for k in given if not k.startswith(own)} == set(wanted)
    assert json.loads(dumps(told)) == told
    assert dumps(told).startswith('{\n "schema": "certreg-result/1",\n "n": 12,\n')


def test_every_field_of_the_equilibria_is_the_number_of_its_name(registration: Registration):
    told = result_document(registration)["equilibria"]
    found = registration.equilibria

    assert (told["count"], told["spurious"], told["complete"]) == (4, 3, True)
    assert told["finite"] is True
    assert told["pattern"] == [1, 1, 1, 1]
    assert told["guarantee"] == found.guarantee.label
    for given, one in zip(told["components"], found.components, strict=True):
        assert given == {
            "kind": "point",
            "dimension": 0,
            "basis": np.asarray(one.basis).tolist(),
            "morse_index": one.morse_index,
            "unstable_eigenvalues": one.unstable_eigenvalues,
            "eigenvalues": [[e.real, e.imag] for e in np.asarray(one.eigenvalues).tolist()],
            "witness": None if one.witness is None else np.asarray(one.witness).tolist(),
            "optimal": one.morse_index == 0,
            "energy": one.energy,
            "rmse": one.rmse,
            "rotation": one.rotation.tolist(),
            "quaternion_wxyz": one.quaternion_wxyz.tolist(),
            "angle_to_optimum_deg": math.degrees(one.angle_to_optimum),
        }


def test_what_is_not_proved_or_not_written_is_null_and_says_why(registration: Registration):
    bare = certify(PROBLEM, relaxation=False, simulation=False)
    missing = replace(bare.solution, certificate=None, absent={"certificate": Absent("lost")})
    lost = {"bounds": None, "absent": {"bounds": Absent("lost")}}
    open_ = replace(bare, bounds=None, absent={"bounds": Absent("lost")})
    huge = replace(
        bare,
        objective=None,
        rmse=None,
        bounds=replace(checked(bare.bounds), greatest_gap=Fraction(10) ** 400),
        absent={"objective": Absent("a"), "rmse": Absent("b")},
    )
    without = replace(bare, solution=missing, **lost)
    told = [result_document(one) for one in (bare, without, open_, huge)]

    assert [one["certificate"] for one in told] == [None] * 4
    assert told[0]["reasons"]["certificate"] == "nothing is written without --out"
    assert told[1]["reasons"]["certificate"] == "lost"
    assert told[0]["reasons"]["relaxation"] == told[0]["reasons"]["simulation"] == "not asked for"
    for name in ("gap_bound", "gap_share", "angle_bound_rad"):
        assert told[2]["optimality"][name] is None
        assert told[2]["reasons"][f"optimality.{name}"] == "lost"
    assert told[3]["reasons"]["objective"] == "a"
    assert told[3]["reasons"]["rmse"] == "b"
    assert told[3]["reasons"]["optimality.gap_bound"] == OUT_OF_RANGE.reason
    assert told[3]["reasons"]["optimality.gap_share"] == OUT_OF_RANGE.reason
    assert told[3]["optimality"]["angle_bound_rad"] == checked(bare.bounds).angle_upper
    assert replace(open_, verdict=None).status is Optimality.NOT_CERTIFIED
    assert result_document(replace(open_, verdict=None))["theorems"] == []


@pytest.fixture(scope="module")
def enumeration() -> Enumeration[Any]:
    return enumerated(PROBLEM, "all")


def test_the_table_of_methods_has_every_cell_in_its_column(enumeration: Enumeration[Any]):
    headings, *rows = methods_table(enumeration).splitlines()
    decided = [one for one in enumeration.searches if one.critical is not None]
    order = [*decided, *(one for one in enumeration.searches if one.critical is None)]
    starts = [headings.index(word) for word in headings.split()]

    assert len({row[start - 1] for row in rows for start in starts}) == 1  # a gap before each
    for row, one in zip(rows, order, strict=True):
        cells = [row[a:b].strip() for a, b in zip(starts, [*starts[1:], None], strict=True)]
        assert cells[0] == one.method
        assert cells[4] == f"{1000 * one.seconds:.2f} ms"
        if one.critical is None:
            assert cells[1:4] == ["-", "-", "-"]
            assert cells[5] == "undecided"
            continue
        energies = [f"{checked(c.energy):.10g}" for c in enumeration.equilibria.components]
        assert cells[1:4] == ["4 points", " ".join(energies), "0 1 2 3"]
        doubt = "" if one.critical.complete else ", in doubt"
        assert cells[5] == one.critical.guarantee.label + doubt


def test_the_fields_of_methods_are_those_of_the_searches(enumeration: Enumeration[Any]):
    fields, words = methods_fields(enumeration), methods_summary(enumeration)
    comparison = checked(enumeration.comparison)
    apart = replace(comparison, angle=math.pi / 180, energy=0.25)

    assert fields["agreement"] == {
        "rotation_deg": math.degrees(comparison.angle),
        "energy_relative": comparison.energy,
    }
    said = methods_summary(replace(enumeration, comparison=apart))
    assert "agree: rotations to 1 degrees, energies to 0.3 of their range." in said
    assert words.startswith(methods_table(enumeration) + "\n")
    alone = replace(enumeration, searches=enumeration.searches[:1], comparison=None)
    assert methods_summary(alone) == methods_table(alone)
    assert methods_fields(alone) == {}
    for field in fields["roads"]:
        (one,) = [each for each in enumeration.searches if each.method == field["method"]]
        assert field["time_ms"] == 1000 * one.seconds
        assert field["complete"] is True
        if one.critical is not None:
            assert field["energies"] == [c.energy for c in enumeration.equilibria.components]
            assert list(field["indices"]) == [0, 1, 2, 3]
            assert field["guarantee"] == one.critical.guarantee.label


def test_what_a_method_leaves_in_doubt_is_said_beside_it(enumeration: Enumeration[Any]):
    one = next(each for each in enumeration.searches if each.critical is not None)
    critical = replace(checked(one.critical), completeness=None, doubt="a path was lost")
    doubtful = replace(enumeration, searches=(replace(one, critical=critical),))
    field = road_fields(doubtful.searches[0], doubtful)

    assert methods_table(doubtful).splitlines()[1].endswith(f"{critical.guarantee.label}, in doubt")
    assert (field["complete"].value, field["complete"].reason) == (False, "a path was lost")
    for doubt, reason in (("a path was lost", "a path was lost"), (None, "the balls are too wide")):
        parts = tuple(replace(part, index=None) for part in critical.components)
        known = critical.completeness if doubt else checked(one.critical).completeness
        given = replace(critical, components=parts, completeness=known, doubt=doubt)
        field = road_fields(replace(one, critical=given), doubtful)
        assert field["indices"].reason.startswith(reason)


def test_a_simulation_alone_has_the_fields_of_one_in_a_result(registration: Registration):
    solution = registration.solution
    run: Any = solution.trajectory
    for proved in (False, True):
        alone = SimulatedRegistration(
            trajectory=run,
            angle_to_optimum=checked(solution.agreement.simulation),
            in_certified_basin=proved,
            unique=True,
        )
        told = ended(alone).document()
        whole = result_document(registration)["simulation"]

        assert {key: told[key] for key in whole} == {**whole, "in_certified_basin": proved}


class Parts(HTMLParser):
    """Elements of a page with their attributes and texts, in their order."""

    def __init__(self, content: bytes) -> None:
        super().__init__()
        self.found = list[tuple[str, dict[str, str], list[str]]]()
        self._open = list[list[str]]()
        self.feed(content.decode())

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        texts = list[str]()
        self.found.append((tag, {k: v or "" for k, v in attrs}, texts))
        if tag not in {"meta", "input"}:
            self._open.append(texts)

    def handle_endtag(self, tag: str) -> None:
        self._open.pop()

    def handle_data(self, data: str) -> None:
        for texts in self._open:
            texts.append(data)

    def all(self, tag: str, **given: str) -> list[str]:
        """The texts of the elements of a tag with these attributes."""
        wanted = {k.rstrip("_"): v for k, v in given.items()}
        return [
            "".join(texts)
            for t, attrs, texts in self.found
            if t == tag and wanted.items() <= attrs.items()
        ]


@pytest.fixture(scope="module")
def parts(registration: Registration) -> Parts:
    return Parts(html_page(Report.of(registration)))


def test_every_section_of_the_page_is_labelled_by_its_heading(parts: Parts):
    titles = {
        "pose": "The pose Copy 4×4",
        "fit": "The fit no warning",
        "see": "The scene",
        "proved": "Proved of this pose",
        "rests": "Every pose at which it can rest",
        "charts": "In numbers",
        "proof": "What is proved, and how we know",
        "check": "Check it yourself",
        "digits": "The pose, with all digits",
    }
    sections = [attrs for tag, attrs, _ in parts.found if tag == "section" and "id" in attrs]

    assert [one["id"] for one in sections] == list(titles)
    for one in sections:
        assert one["aria-labelledby"] == f"{one['id']}-title"
        assert parts.all("h2", id=one["aria-labelledby"]) == [titles[one["id"]]]
    charts = [attrs["id"] for tag, attrs, _ in parts.found if tag == "figure"]
    assert charts == ["histogram", "energy", "residuals", "margin", "spectrum"]
    captions = ["Energy along", "Distances of", "Ambiguity margin", "Eigenvalues at"]
    for name, caption in zip(charts[1:], captions, strict=True):
        assert parts.all("figure", id=name)[0].startswith(caption)


def test_every_sentence_of_the_page_comes_before_how_it_is_known(parts: Parts):
    known = [t for t in parts.found if t[0] in {"li", "p", "span"} and not t[1].get("role")]
    places = [k for k, one in enumerate(known) if one[1].get("class", "").startswith("how ")]

    assert places
    for k in places:
        (item, sentence, rests, label) = known[k - 3 : k + 1]
        assert (item[0], sentence[0], sentence[1], rests[1]["class"]) == ("li", "p", {}, "rests-on")
        assert label[1]["class"] == f"how {''.join(label[2])}"
        assert "".join(label[2]) in {"exact", "enclosed", "numerical"}


def test_the_head_of_the_page_says_what_it_is_once_each(parts: Parts, registration: Registration):
    metas = [attrs for tag, attrs, _ in parts.found if tag == "meta"]
    named = {one["name"]: one["content"] for one in metas if "name" in one}

    assert named["color-scheme"] == "light dark"
    assert named["viewport"] == "width=device-width, initial-scale=1"
    assert named["generator"].startswith("certreg ")
    assert parts.all("title") == ["Certified: source to target"]
    stamp, _, said = registration_summary(registration).splitlines()[0].partition(": ")
    assert [stamp] == parts.all("p", class_="stamp good")
    assert parts.all("h1") == [said[0].upper() + said[1:]]
    scripts = [attrs for tag, attrs, _ in parts.found if tag == "script"]
    assert scripts == [
        {"id": "scene", "type": "application/json"},
        {"id": "certificate", "type": "text/plain"},
        {},
    ]


def test_a_page_carries_a_certificate_up_to_the_limit_and_names_a_larger_one(
    registration: Registration,
):
    report = Report.of(registration)

    assert EMBEDDED_BYTES == 8 * 1024**2
    assert is_green(registration)
    assert not is_green(replace(registration, bounds=None))
    for size, carried in ((EMBEDDED_BYTES, True), (EMBEDDED_BYTES + 1, False)):
        assert replace(report, content=b" " * size).embedded == carried


def test_a_weak_certificate_gives_the_weak_headline_unless_it_is_only_bounded(
    registration: Registration,
):
    bounded = replace(registration, limits=Limits(max_gap=0.0))
    weak, plain = (replace(Report.of(registration), weak=weak) for weak in (True, False))
    loose = replace(Report.of(bounded), weak=True)

    assert weak.headline is listed.WEAK
    assert plain.headline is headline_of(registration)
    assert loose.headline is headline_of(bounded) is listed.BOUNDED
    counts = [len(one.verdict_words) for one in (plain, weak, Report.of(bounded), loose)]
    assert counts == [1, 2, 2, 3]
    assert weak.verdict_words[0] == listed.WEAK.said()
    assert loose.verdict_words[0].startswith("BOUNDED: ")
    assert weak.verdict_words[1] == loose.verdict_words[1]


@pytest.mark.parametrize(
    ("words", "parts"),
    [
        ("12 % of the range: far", ("12 %", "of the range: far")),
        ("none", ("none", "")),
        ("0: every rotation is an optimum", ("0", "every rotation is an optimum")),
    ],
)
def test_a_margin_is_split_into_its_figure_and_its_words(words: str, parts: tuple[str, str]):
    assert split(words) == parts
