"""`certreg reproduce`: every finding is confirmed, and none when what it poses on is wrong."""

from __future__ import annotations

import json
import re
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import replace
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import certreg, strict_json
from jsonschema import Draft202012Validator
from matplotlib.figure import Figure

from certreg.cli.progress import Stages
from certreg.native.engine import current_engine
from certreg.native.layout import plain
from certreg.paper import claims, derivation, experiments, verdicts
from certreg.paper.claims import MEASURED, listed, rough
from certreg.paper.derivation import proving
from certreg.paper.documents import (
    claim_text,
    closing_text,
    html_page,
    markdown,
    reproduction_document,
)
from certreg.paper.figures import (
    _boxes,
    _caption,
    _error_words,
    angle_errors,
    construction_drawing,
    paper_drawings,
    simulation_drawing,
    typical,
)
from certreg.paper.observations import Observations, Setup, observe
from certreg.paper.particles import Particles
from certreg.paper.style import DPI, WIDTH, written
from certreg.paper.verdicts import in_doubles, reproduce
from certreg.problem.problem import RegistrationProblem
from certreg.results import Ruling, Verdict

if TYPE_CHECKING:
    from pathlib import Path

RUNS = 5
ROWS = {row.number: row for row in derivation.paper_claims()}
PROVED = Verdict(ruling=Ruling.PROVED, words="taken as proved")
SCHEMA = json.loads(
    (files("certreg.report") / "schemas" / "certreg-reproduction-1.json").read_text("utf-8")
)


def quiet(stage: str, done: int, total: int) -> None:
    """Shows no progress."""


@pytest.fixture(scope="module")
def made():
    return reproduce(Setup(runs=RUNS), quiet, proofs=False)


@pytest.fixture(scope="module")
def seen(made) -> Observations:
    return made.observations


@pytest.fixture(scope="module")
def drawn(seen):
    return paper_drawings(seen)


def evidence(number: str, seen: Observations, clouds: list[RegistrationProblem] | None = None):
    if clouds is None:
        example = ROWS[number].counterexample
        clouds = [in_doubles(c) for c in (example.clouds if example else ())]
    return MEASURED[number](seen, clouds)


# what is measured agrees with the findings, and does not when something is wrong


def test_every_claim_of_the_audit_is_measured_and_no_other():
    assert list(MEASURED) == list(ROWS)


@pytest.mark.parametrize("number", ROWS)
def test_the_measurement_agrees_with_the_finding(number: str, seen):
    found = evidence(number, seen)

    assert found.agrees is True, found.words


def worse(runs: tuple[Any, ...], **changes: Any) -> tuple[Any, ...]:
    """The runs with the last one changed."""
    return (*runs[:-1], replace(runs[-1], **changes))


def worse_pose(seen: Observations, which: int, **changes: Any) -> Observations:
    poses = list(seen.equilibria[-1].poses)
    poses[which] = replace(poses[which], **changes)
    return replace(seen, equilibria=worse(seen.equilibria, poses=tuple(poses)))


def with_eigenvalue(seen: Observations, which: int, kind: str, value: complex) -> Observations:
    values = getattr(seen.equilibria[-1].poses[which], kind).copy()
    values[np.argmax(values.real)] = value
    return worse_pose(seen, which, **{kind: values})


FAULTS = {
    "1": lambda seen: replace(seen, comparisons=worse(seen.comparisons, objective=1e-9)),
    "2": lambda seen: replace(seen, comparisons=worse(seen.comparisons, rate=1e-9)),
    "3": lambda seen: replace(seen, comparisons=worse(seen.comparisons, dissipation=1e-9)),
    "4b": lambda seen: replace(seen, simulations=worse(seen.simulations, midpoint_at_rest=False)),
    "5": lambda seen: worse_pose(seen, 2, balance=1e-9),
    "6a": lambda seen: replace(seen, equilibria=worse(seen.equilibria, unique=False)),
    "6b": lambda seen: worse_pose(seen, 0, angle=1e-6),
    "7": lambda seen: replace(seen, equilibria=worse(seen.equilibria, count=None)),
    "8a": lambda seen: replace(seen, equilibria=worse(seen.equilibria, count=5)),
    "8b": lambda seen: worse_pose(seen, 3, half_turn_error=1e-6),
    "9b": lambda seen: replace(seen, balance_sums=((0, 0, 1, 0), seen.balance_sums[1])),
    "10": lambda seen: with_eigenvalue(seen, 1, "intrinsic", -1.0),
    "11": lambda seen: with_eigenvalue(seen, 3, "ambient", -1.0),
    "12": lambda seen: with_eigenvalue(seen, 0, "ambient", -1.0),
    "13a": lambda seen: replace(seen, simulations=worse(seen.simulations, midpoint_rise=1e-9)),
    "15d": lambda seen: replace(seen, simulations=worse(seen.simulations, distance=180.0)),
    "15e": lambda seen: with_eigenvalue(seen, 1, "ambient", -1.0),
    "13b": lambda seen: replace(seen, simulations=worse(seen.simulations, first_rise=-1e-9)),
    "14": lambda seen: replace(seen, equilibria=worse(seen.equilibria, least_inertia=0.0)),
    "15a": lambda seen: replace(seen, simulations=worse(seen.simulations, distance=180.0)),
    "15b": lambda seen: replace(
        seen,
        simulations=worse(seen.simulations, stopped=False),
    ),
}
MORE_FAULTS = {
    "8b": lambda seen: replace(
        seen, equilibria=worse(seen.equilibria, pair_errors=(*[0.0] * 5, 1e-6))
    ),
    "9b": lambda seen: replace(
        seen, turns=(seen.turns[0], replace(seen.turns[1], unstable=seen.turns[1].unstable * 0))
    ),
    "11": lambda seen: with_eigenvalue(seen, 2, "intrinsic", 1e-15),
    "13b": lambda seen: replace(seen, simulations=worse(seen.simulations, predicted_rise=0.0)),
}


@pytest.mark.parametrize(
    ("number", "fault"), [*FAULTS.items(), *MORE_FAULTS.items()], ids=lambda value: str(value)[:4]
)
def test_one_run_that_is_otherwise_is_enough_to_disagree(number: str, fault, seen):
    assert evidence(number, fault(seen)).agrees is False


TOLD = {"1": 1e-9, "2": 1e-9, "3": 1e-9, "5": 1e-9, "6b": 1e-6, "8b": 1e-6}


@pytest.mark.parametrize(
    ("number", "fault"), [*FAULTS.items(), *MORE_FAULTS.items()], ids=lambda value: str(value)[:4]
)
def test_the_words_tell_of_the_run_that_is_otherwise(number: str, fault, seen):
    words = evidence(number, fault(seen)).words

    assert words != evidence(number, seen).words
    if number in TOLD:
        assert rough(TOLD[number]) in words


@pytest.mark.parametrize("number", [n for n, row in ROWS.items() if row.counterexample])
def test_other_clouds_than_the_counterexamples_do_not_refute_the_claim(number: str, seen):
    """In their place a generic cloud onto itself; rows that use no cloud have a fault above."""
    source = np.random.default_rng(0).normal(size=(6, 3))
    generic = RegistrationProblem(source, source + np.array([0.1, 0.2, 0.3]))
    clouds = [generic] * len(ROWS[number].counterexample.clouds)
    unused = {"12", "13b"}

    assert evidence(number, seen, clouds).agrees is (number in unused)
    assert unused <= set(FAULTS)


def test_every_row_is_seen_to_fail():
    counterexamples = {n for n, row in ROWS.items() if row.counterexample}

    assert set(FAULTS) | counterexamples == set(ROWS)


# wrong equations


class WrongEngine:
    """The engine, with a mistake in what it runs."""

    def __init__(self, mistake: Any) -> None:
        self._mistake = mistake

    def run(self, batch, rules, log=None) -> None:
        self._mistake(batch)
        current_engine().run(batch, rules, log)


def failed(setup: Setup) -> set[str]:
    found = reproduce(setup, quiet, proofs=False)
    assert not found.stands
    return {claim.row.number for claim in found.claims if not claim.stands}


SMALL = Setup(runs=2)


@pytest.mark.slow
def test_a_wrong_sign_in_the_torque_of_the_paper_is_seen(monkeypatch):
    right = Particles.torque
    monkeypatch.setattr(Particles, "torque", lambda self, state: -right(self, state))

    assert failed(SMALL) >= {"2", "3"}


@pytest.mark.slow
def test_a_wrong_energy_is_seen(monkeypatch):
    right = Particles.potential
    monkeypatch.setattr(Particles, "potential", lambda self, state: 1.01 * right(self, state))

    assert "3" in failed(SMALL)


@pytest.mark.slow
def test_springs_that_push_are_seen(monkeypatch):
    def mistake(batch) -> None:
        batch.bodies["cross"] *= -1.0

    monkeypatch.setattr(experiments, "current_engine", lambda: WrongEngine(mistake))

    assert failed(SMALL) >= {"15a"}


@pytest.mark.slow
def test_a_wrong_inertia_is_seen(monkeypatch):
    def mistake(batch) -> None:
        batch.bodies["inertia_inverse"] *= 1.1  # J alpha is not the torque any more

    monkeypatch.setattr(experiments, "current_engine", lambda: WrongEngine(mistake))

    assert failed(SMALL) >= {"13b"}


@pytest.mark.slow
def test_a_step_without_projection_is_seen(monkeypatch):
    class Unprojected:
        """Explicit Euler in the 18 numbers: R leaves the rotations."""

        def run(self, batch, rules, log=None) -> None:
            (state,), (body,), ((step,),) = map(plain, (batch.states, batch.bodies, batch.steps))
            for k in range(min(rules.max_steps, 400)):
                if log is not None:
                    (energies,) = current_engine().evaluate("certreg_energies", state, body)
                    plain(log.rows)[log.count] = [k * step, *state, *energies]
                    log.count += 1
                state += step * current_engine().evaluate("certreg_rate", state, body)[0]
            batch.status[0] = 1

    monkeypatch.setattr(experiments, "current_engine", Unprojected)

    assert "15a" in failed(SMALL)


def test_an_eigenvalue_counted_on_the_wrong_side_is_seen(monkeypatch, seen):
    right = experiments.sides
    monkeypatch.setattr(experiments, "sides", lambda values: -right(values))

    assert evidence("11", seen).agrees is False
    assert evidence("12", seen).agrees is False


@pytest.mark.long
def test_a_damping_that_explicit_euler_cannot_follow_is_told_and_confirms_the_condition(drawn):
    found = reproduce(Setup(runs=1, damping=250.0), quiet, proofs=False)
    document = reproduction_document(found, drawn)
    box_plot, *_ = simulation_drawing(found.observations).figure.axes

    assert found.stands
    assert document["simulations"]["diverged"] == 1
    assert document["simulations"]["steps"]["max"] < 1000
    assert document["simulations"]["simulation_error_deg"]["max"] is None
    assert "simulations" in document["reasons"]
    assert Draft202012Validator(SCHEMA).is_valid(document)
    assert box_plot.has_data()


# proofs


@pytest.mark.long
@pytest.mark.slow
def test_claims_are_proved_in_processes_of_their_own(monkeypatch):
    monkeypatch.setattr("certreg.campaign.workers._processors", lambda: 1)
    with proving(["inertia", "davenport"]) as coming:
        found = {name: future.result(timeout=120) for name, future in coming.items()}

    assert set(found) == {"inertia", "davenport"}
    assert all(verdict.proved for verdict in found.values())


def proofs_are(verdict: Verdict):
    @contextmanager
    def standing_in(names):
        futures = {name: Future() for name in names}
        for name, future in futures.items():
            future.set_result(PROVED if name != "dissipation" else verdict)
        yield futures

    return standing_in


@pytest.mark.slow
def test_a_claim_that_is_not_proved_is_not_confirmed(monkeypatch):
    refuted = Verdict(ruling=Ruling.REFUTED, words="a step failed")
    monkeypatch.setattr(verdicts, "proving", proofs_are(refuted))

    found = reproduce(SMALL, quiet)

    assert not found.stands
    resting = {number for number, row in ROWS.items() if "dissipation" in row.because}
    assert {c.row.number for c in found.claims if not c.stands} == resting
    assert "13a" in resting


# figures


def by_name(drawn, name: str):
    return next(drawing for drawing in drawn if drawing.name == name)


def test_there_is_a_figure_for_every_experiment(drawn):
    assert [drawing.name for drawing in drawn] == [
        "construction",
        "polygons",
        "eigenvalues-intrinsic",
        "eigenvalues-ambient",
        "angles",
        "simulations",
        "poses",
    ]


@pytest.mark.parametrize(("kind", "size"), [("intrinsic", 12), ("ambient", 18)])
def test_the_panels_show_every_eigenvalue_on_its_side(kind: str, size: int, drawn):
    panels = by_name(drawn, f"eigenvalues-{kind}").figure.axes
    shown = [[len(group.get_offsets()) for group in panel.collections] for panel in panels]
    zeros = 6 * RUNS if kind == "ambient" else 0

    for index, (left, right, zero) in enumerate(shown):
        assert (right, zero) == (index * RUNS, zeros)
        assert left == (size - index) * RUNS - zeros
    for panel in panels:
        (right, _, _) = (panel.collections[k].get_offsets() for k in (1, 0, 2))
        assert (right[:, 0] > 0).all()


def test_the_angles_shown_are_the_errors_of_both_formulas(drawn, seen):
    panel = by_name(drawn, "angles").figure.axes[0]
    rows = angle_errors(seen.equilibria)

    assert [len(errors) for errors in rows.values()] == [3 * RUNS, 3 * RUNS, RUNS, RUNS]
    for group, errors in zip(panel.collections, rows.values(), strict=True):
        np.testing.assert_allclose(
            group.get_offsets()[:, 0], np.maximum(errors, panel.lines[0].get_xdata()[0])
        )
    by_quaternion, by_arccos, *_ = rows.values()
    assert by_quaternion.max() < 1e-10 < by_arccos.max()


def test_the_boxes_and_curves_are_those_of_the_runs(drawn, seen):
    left, middle, right = by_name(drawn, "simulations").figure.axes
    runs = seen.simulations
    shown = typical(runs)
    medians = [line.get_ydata()[0] for line in left.lines if len(set(line.get_ydata())) == 1]
    energy = shown.energy

    for name in ("closed_form_error", "error", "distance"):
        assert any(np.isclose(np.median([getattr(run, name) for run in runs]), medians))
    assert shown.steps == sorted(run.steps for run in runs)[RUNS // 2]
    total, potential = (line.get_ydata() for line in middle.lines)
    np.testing.assert_allclose(total, (energy - shown.least) / (energy[0] - shown.least))
    assert (total >= potential).all()
    np.testing.assert_allclose(
        right.lines[1].get_ydata(), 1e6 * (energy[:13] / energy[0] - 1), rtol=1e-6, atol=1e-6
    )


def test_the_drawn_torques_sum_to_the_heavy_line(drawn):
    _, _, *panels = by_name(drawn, "polygons").figure.axes

    for panel, corners in zip(panels, (3, 4), strict=True):
        *torques, total, _ = (np.asarray(line.get_ydata()) for line in panel.lines)
        assert len(torques) == corners
        np.testing.assert_allclose(sum(torques), total, atol=1e-14)
        assert np.abs(total).max() < 1e-14


def test_every_spring_of_the_construction_is_drawn_between_its_points(drawn, seen):
    (panel,) = by_name(drawn, "construction").figure.axes
    ends = {tuple(np.round(line.get_xydata()[[0, -1]], 9).ravel()) for line in panel.lines[:10]}

    assert len(ends) == len(seen.scene.source)


def test_the_poses_show_every_point_of_both_clouds(drawn, seen):
    for panel, pose in zip(by_name(drawn, "poses").figure.axes, seen.gallery.poses, strict=True):
        sizes = [len(line.get_xdata()) for line in panel.lines]
        assert sizes.count(2) == len(pose.points)
        assert sizes.count(len(pose.points)) == 2


def test_no_label_is_cut_off_too_small_or_on_top_of_another(drawn):
    for drawing in drawn:
        figure = drawing.figure
        renderer = figure._get_renderer()
        frame = figure.bbox.padded(0.5)
        texts = shown_texts(figure)
        boxes = [text.get_window_extent(renderer) for text in texts]
        assert texts, drawing.name
        for text, box in zip(texts, boxes, strict=True):
            whole = [frame.x0 <= box.x0, box.x1 <= frame.x1, frame.y0 <= box.y0, box.y1 <= frame.y1]
            assert all(whole), (drawing.name, text)
            assert text.get_fontsize() >= 7.5
        for k, box in enumerate(boxes):
            over = [texts[j].get_text() for j in range(k) if box.overlaps(boxes[j])]
            assert over == [], (drawing.name, texts[k].get_text())


def shown_texts(figure: Any) -> list[Any]:
    """Every text that is to be read: of legends and panels, labels of ticks inside of these."""
    found = [text for legend in figure.legends for text in legend.get_texts()]
    for axes in figure.axes:
        found += [axes.title, axes._left_title, *axes.texts]
        found += axes.get_legend().get_texts() if axes.get_legend() else []
        for axis in (axes.xaxis, axes.yaxis) if axes.axison else ():
            low, high = sorted(axis.get_view_interval())
            ticks = [tick for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
            found += [axis.label, *(tick.label1 for tick in ticks)]
    found += [figure._supxlabel] if figure._supxlabel else []
    return [text for text in found if text.get_visible() and text.get_text().strip()]


def test_figures_are_of_the_pages_width(drawn):
    assert int.from_bytes(written(drawn[0], "png")[16:20], "big") == round(WIDTH * DPI)


@pytest.mark.slow
@pytest.mark.parametrize(
    "kind", ["png", *(pytest.param(kind, marks=pytest.mark.long) for kind in ("svg", "pdf"))]
)
def test_figures_are_the_same_bytes_again(kind: str, drawn):
    assert written(drawn[0], kind) == written(drawn[0], kind)


def test_captions_say_how_many_runs_they_show(drawn):
    for name in ("eigenvalues-intrinsic", "eigenvalues-ambient", "angles", "simulations"):
        assert f"{RUNS} random instances" in by_name(drawn, name).caption


@pytest.mark.parametrize(
    ("energies", "rises"),
    [([1, 2, 3, 4], 3), ([1, 2, 1, 5], 1), ([2, 1, 3, 4], 0), ([1, 2, 2, 3], 1), ([1, 0], 0)],
)
def test_the_caption_counts_the_first_steps_that_raise_the_energy(seen, energies, rises: int):
    run = seen.simulations[0]
    potential = np.array(energies, dtype=float)
    bare = replace(run, potential=potential, kinetic=0.0 * potential, times=potential)
    for potential_rises, words in ((1, "under it oscillates."), (0, "under it falls with it.")):
        shown = replace(bare, potential_rises=potential_rises)

        told = _caption([shown], shown)
        assert f"raises V in the first {rises} steps" in told
        assert f"A run of {len(energies) - 1} steps, the median" in told
        assert words in told


def test_the_errors_of_a_simulation_stand_under_their_names(seen):
    """The closed form's below 1 degree, the simulation's below 3, between them below 9."""
    runs = tuple(
        replace(run, closed_form_error=0.5 + k / 10, error=2.5 + k / 10, distance=8.5 + k / 10)
        for k, run in enumerate(seen.simulations)
    )
    panel = Figure().add_subplot()
    _boxes(panel, runs)
    named = {
        label.get_text().replace("-\n", "").replace("\n", " "): position
        for position, label in zip(panel.get_xticks(), panel.get_xticklabels(), strict=True)
    }
    lines = [line for line in panel.get_lines() if line.get_linewidth() == 1.4]
    ends = [np.asarray(line.get_xydata(), dtype=float) for line in lines]
    medians = {round(float(x.mean())): float(y[0]) for x, y in (each.T for each in ends)}

    assert {name: medians[round(at)] for name, at in named.items()} == pytest.approx(
        {"closed form": 0.7, "simulation": 2.7, "between them": 8.7}
    )
    words = _error_words(runs)
    assert "the closed form is 0.700° from the true rotation" in words
    assert "the simulation 2.700°" in words
    assert "8.700° lie between the two" in words


def test_the_stiffness_in_the_figure_is_twice_the_weight(drawn):
    """V = sum of |x - y|^2 / sigma^2 is the energy k/2 |x - y|^2 of springs of k = 2 / sigma^2."""
    (legend,) = by_name(drawn, "construction").figure.legends

    assert r"springs, $k_i = 2/\sigma_i^2$" in [text.get_text() for text in legend.get_texts()]


def test_the_users_own_matplotlib_settings_do_not_enter(drawn, seen):
    import matplotlib as mpl

    before = written(by_name(drawn, "construction"), "svg")
    with mpl.rc_context({"font.size": 30, "lines.linewidth": 9}):
        again = construction_drawing(seen)
        assert written(again, "svg") == before
        assert mpl.rcParams["font.size"] == 30


# documents and command


def test_the_document_is_valid_and_its_counts_are_measured(made, drawn):
    document = strict_json(json.dumps(reproduction_document(made, drawn), allow_nan=False))

    assert [e.message for e in Draft202012Validator(SCHEMA).iter_errors(document)] == []
    assert document["equilibria"]["pattern_0123"] == document["equilibria"]["runs"] == RUNS
    assert document["simulations"]["at_optimum"] == RUNS
    assert document["equilibria"]["exceptions"] == []
    assert document["confirmed"] is True
    assert [claim["proved"] for claim in document["claims"]] == [None] * len(ROWS)
    assert document["reasons"]


@pytest.mark.parametrize("lost", [0, 1, RUNS - 1, RUNS])
def test_simulations_are_said_to_be_missing_only_where_every_one_diverged(made, drawn, lost):
    runs = tuple(
        replace(run, diverged=k < lost) for k, run in enumerate(made.observations.simulations)
    )
    observed = replace(made.observations, simulations=runs)
    document = reproduction_document(replace(made, observations=observed), drawn)

    assert document["simulations"]["diverged"] == lost
    assert ("simulations" in document["reasons"]) == (lost == RUNS)


def test_a_run_of_another_pattern_is_listed(made, drawn):
    odd = with_eigenvalue(made.observations, 3, "intrinsic", -1.0)

    document = reproduction_document(replace(made, observations=odd), drawn)

    assert document["equilibria"]["pattern_0123"] == RUNS - 1
    assert document["equilibria"]["exceptions"] == [
        {"run": RUNS - 1, "count": 4, "unstable": [0, 1, 2, 2]}
    ]
    assert f"{RUNS - 1} of {RUNS} runs" in closing_text(replace(made, observations=odd))


def test_the_table_has_a_line_for_every_claim_and_equal_cells(made, drawn):
    lines = [line for line in markdown(made, drawn).splitlines() if line.startswith("|")]

    assert len(lines) == len(ROWS) + 2
    assert {line.replace("\\|", "").count("|") for line in lines} == {9}


def test_without_proofs_nothing_is_said_to_be_confirmed_or_proved(made, drawn):
    spoken = map(claim_text, made.claims)
    table = [line for line in markdown(made, drawn).splitlines() if line.startswith("| ")][2:]
    document = reproduction_document(made, drawn)

    assert all("(finding measured, not proved in this run)" in text for text in spoken)
    assert [line.split(" | ")[-2:] for line in table[-len(ROWS) :]] == [
        ["not in this run", "finding measured, not proved in this run |"]
    ] * len(ROWS)
    assert "confirmed" not in closing_text(made)
    assert "none was proved in this run" in closing_text(made)
    assert "finding measured, not proved in this run" in html_page(made, drawn[:1])
    assert {c["verdict"] for c in document["claims"]} == {
        "finding measured, not proved in this run"
    }


def test_a_false_claim_is_not_said_to_be_confirmed(made, drawn):
    proved = replace(made, claims=tuple(replace(c, proof=PROVED) for c in made.claims))
    false = [c for c in proved.claims if c.row.finding.value == "false as stated"]

    assert false
    for claim in false:
        head = claim_text(claim).splitlines()[0].strip()
        assert head == f"{claim.row.number}  FALSE AS STATED (finding confirmed)"
    assert html_page(proved, drawn[:1]).count('<p class="state">finding confirmed</p>') == len(ROWS)
    assert markdown(proved, drawn).count(" | finding confirmed |") == len(ROWS)


def test_the_page_is_one_file_with_every_claim_and_figure(made, drawn):
    drawn = drawn[:2]
    html = html_page(made, drawn)

    assert html.count("<article") == len(ROWS)
    assert html.count('<img src="data:image/svg+xml;base64,') == len(drawn)
    assert re.findall(r"(?:src|href)=\"(?!data:)", html) == []
    assert "<script" not in html
    for drawing in drawn:
        assert drawing.title in html


def test_the_page_shows_a_finding_that_is_not_confirmed(made, drawn):
    last = made.claims[-1]
    wrong = replace(last, evidence=replace(last.evidence, agrees=False, words="a < b & c"))

    html = html_page(replace(made, claims=(*made.claims[:-1], wrong)), drawn[:1])

    assert '<strong class="failed">finding NOT CONFIRMED</strong>' in html
    assert "a &lt; b &amp; c" in html


@pytest.mark.slow
def test_the_command_confirms_every_finding_and_writes_everything(
    tmp_path: Path, monkeypatch, drawn
):
    monkeypatch.setattr("certreg.cli.reproducing.paper_drawings", lambda seen: drawn[2:3])
    monkeypatch.setattr(verdicts, "proving", proofs_are(PROVED))

    run = certreg("reproduce", "--runs", "2", "--out", tmp_path / "out")

    assert (run.code, run.err) == (0, "")
    assert "27 of 27 findings are confirmed" in run.out
    assert "in 2 of 2 runs; 2 of 2 simulations" in run.out
    written_files = {str(p.relative_to(tmp_path / "out")) for p in tmp_path.rglob("*.*")}
    assert {"verdicts.html", "verdicts.md", "verdicts.json"} <= written_files
    document = strict_json((tmp_path / "out" / "verdicts.json").read_bytes())
    assert Draft202012Validator(SCHEMA).is_valid(document)
    for figure in document["figures"]:
        assert {*figure["files"], f"figures/{figure['name']}.txt"} <= written_files
    assert all(claim["proved"] for claim in document["claims"])
    certificates = [each for claim in document["claims"] for each in claim["certificates"]]
    assert {file for each in certificates for file in each["files"]} <= written_files
    assert all(each["verified"] for each in certificates)
    assert (document["maps"], "maps.csv" in written_files) == ([], False)


@pytest.mark.slow
def test_a_finding_that_is_not_confirmed_is_exit_code_1(tmp_path: Path, monkeypatch, drawn):
    monkeypatch.setattr("certreg.cli.reproducing.paper_drawings", lambda seen: drawn[:0])
    monkeypatch.setattr(claims, "SPIRAL_RATIO", 1.0)

    run = certreg("reproduce", "--runs", "1", "--no-proofs", "--out", tmp_path)

    assert run.code == 1
    assert "15b  TRUE UNDER A CONDITION (finding NOT CONFIRMED)" in run.out
    assert "26 of 27 findings agree with what was measured, none was proved in this run" in run.out
    assert strict_json((tmp_path / "verdicts.json").read_bytes())["confirmed"] is False


@pytest.mark.parametrize(
    "arguments",
    [("--runs", "0"), ("--points", "2"), ("--damping", "0"), ("--noise", "-1"), ("--seed", "-1")],
)
def test_bad_usage_is_exit_code_2(arguments, tmp_path: Path):
    run = certreg("reproduce", *arguments, "--out", tmp_path / "out")

    assert (run.code, run.out) == (2, "")
    assert arguments[0] in run.err
    assert not (tmp_path / "out").exists()


def test_a_file_in_the_way_is_told_before_anything_is_run(tmp_path: Path, monkeypatch):
    monkeypatch.setattr(verdicts, "observe", None)
    (tmp_path / "file").write_text("", "utf-8")

    run = certreg("reproduce", "--out", tmp_path / "file" / "folder")

    assert (run.code, run.out) == (2, "")
    assert "cannot be made a folder" in run.err


@pytest.mark.slow
def test_one_seed_gives_the_same_observations_and_another_others():
    first, again, other = (observe(Setup(runs=1, seed=seed), quiet) for seed in (1, 1, 2))

    assert first.simulations[0].error == again.simulations[0].error
    assert first.simulations[0].error != other.simulations[0].error


@pytest.mark.slow
def test_progress_counts_up_to_the_end():
    told: list[tuple[str, int, int]] = []

    reproduce(SMALL, lambda stage, done, total: told.append((stage, done, total)), proofs=False)

    assert told == [(s, k, 2) for s in ("equilibria", "simulations") for k in range(3)]


@pytest.mark.parametrize(
    ("value", "words"),
    [(6.1e-16, "7·10⁻¹⁶"), (1e6, "1·10⁶"), (9.5e-3, "1·10⁻²"), (0.0, "0"), (2e-3, "2·10⁻³")],
)
def test_rough_numbers_are_rounded_up(value: float, words: str):
    assert rough(value) == words


def test_counts_are_listed_in_words():
    assert listed([1, 2, None]) == "1, 2 and infinitely many"
    assert listed([None]) == "infinitely many"


def paths_of(value: Any, path: tuple[str, ...] = ()):
    if isinstance(value, dict):
        for key, inner in value.items():
            yield (*path, key)
            yield from paths_of(inner, (*path, key))


@pytest.mark.slow
@pytest.mark.parametrize("every", [4, pytest.param(1, marks=pytest.mark.long)])
def test_no_key_of_the_document_may_be_missing_or_of_another_type(every: int, made, drawn):
    document = reproduction_document(made, drawn)
    validator = Draft202012Validator(SCHEMA)
    free = {("reasons", key) for key in document["reasons"]}

    for path in sorted({*paths_of(document)} - free)[::every]:
        for wrong in (None, {"not": [1]} if path != ("reasons",) else 1, [[[[]]]]):
            changed = json.loads(json.dumps(document))
            part = changed
            for key in path[:-1]:
                part = part[key]
            if wrong is None:
                del part[path[-1]]
            else:
                part[path[-1]] = wrong
            assert not validator.is_valid(changed), (path, wrong)


@pytest.mark.parametrize(
    ("key", "value"),
    [("finding", "maybe"), ("proved", 1), ("proofs", []), ("number", "x"), ("measured", "")],
)
def test_a_claim_that_is_wrong_is_not_valid(key: str, value: Any, made, drawn):
    document = reproduction_document(made, drawn)
    document["claims"][0][key] = value

    assert not Draft202012Validator(SCHEMA).is_valid(document)


def test_the_stage_of_a_long_run_is_shown_to_a_terminal_only(monkeypatch, capsys):
    monkeypatch.setattr("certreg.cli.progress.PATIENCE", -1.0)
    for watched in (True, False):
        monkeypatch.setattr("sys.stderr.isatty", lambda watched=watched: watched)
        with Stages() as stages:
            stages.at("equilibria", 3, 50)
            stages.at("figures")
        shown = capsys.readouterr().err
        assert ("equilibria 3 of 50 ..." in shown) is watched
        assert shown.endswith("\033[K") is watched
