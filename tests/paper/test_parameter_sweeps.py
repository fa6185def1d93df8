"""Sweeps beyond the paper: what is measured obeys the theory beside it, and is what is drawn."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from commands import certreg, strict_json
from jsonschema import Draft202012Validator
from test_reproduce import SCHEMA, shown_texts

from certreg.campaign.table import records_bytes
from certreg.dynamics.batch import bodies_of, simulate_many
from certreg.dynamics.integrators import SimulationSettings
from certreg.equilibrium.batch import solve_many
from certreg.native.loops import Integrator
from certreg.paper import parameter_sweeps as sweeping
from certreg.paper.map_figures import WORDS, sweep_drawings
from certreg.paper.parameter_families import CUBE, FAMILIES, Family, limit_margin, margin
from certreg.paper.parameter_sweeps import (
    QUANTITIES,
    Measurements,
    Sweep,
    all_sweeps,
    instance_count,
    measurements,
    sweep_rows,
)
from certreg.problem.motion import DEFAULT_DAMPING
from certreg.problem.random_instances import gaussian_instances

COUNT = 40


def quiet(stage: str, done: int, total: int) -> None:
    """Shows no progress."""


def measured(name: str, value: float, count: int = COUNT):
    return measurements(FAMILIES[name], value, np.random.default_rng(1), count)


def short(family: Family) -> Family:
    values = family.values
    return replace(family, values=(values[0], *values[len(values) // 2 :: 3][:2], values[-1]))


@pytest.fixture(scope="module")
def found() -> tuple[Sweep, ...]:
    """All maps at few values, of few and small clouds."""
    kept = dict(FAMILIES)
    patch = pytest.MonkeyPatch()
    for name, family in kept.items():
        few = short(family)
        if name == "points":
            few = replace(few, values=(3.0, 100.0, 1000.0))
        patch.setitem(FAMILIES, name, few)
    try:
        return all_sweeps(0, 8, quiet)
    finally:
        patch.undo()


@pytest.fixture(scope="module", params=[2, pytest.param(None, marks=pytest.mark.long)])
def shown(request, found) -> tuple[Sweep, ...]:
    """The maps of which figures are drawn, some or all: each takes a fifth of a second."""
    return found[: request.param]


@pytest.fixture(scope="module")
def drawn(shown):
    return sweep_drawings(shown)


# theory


@pytest.mark.parametrize("mu", [0.1, 0.5, 1.0, 10.0])
def test_the_motion_dies_out_at_the_rate_of_the_slowest_mode(mu: float):
    """Between two stops a million apart: explicit Euler multiplies by |1 + h s| in each step."""
    made = gaussian_instances(np.random.default_rng(2), count=COUNT)
    modes = solve_many(made.sources, made.targets, damping=mu, spectrum=True).eigenvalues
    assert modes is not None
    bodies = bodies_of(made.sources, made.targets, damping=mu)
    first, last = (
        simulate_many(
            bodies, Integrator.EULER, settings=SimulationSettings(speed_tolerance=tolerance)
        ).steps
        for tolerance in (1e-4, 1e-10)
    )

    told = math.log(1e6) / -np.log(np.abs(1.0 + 0.01 * modes[:, 0, 0]))

    np.testing.assert_allclose(np.median((last - first) / told), 1.0, atol=0.03)


@pytest.mark.one_in(4)
@pytest.mark.parametrize("mu", [0.1, 1.0, 2.2, 10.0])
def test_the_steps_are_those_that_the_slowest_mode_tells(mu: float):
    found = measured("damping", mu)

    ratios = found.steps / found.predicted_steps
    assert found.converged.all()
    assert 1.0 < np.median(ratios) < 1.3


@pytest.mark.slow
def test_the_fewest_steps_are_made_near_optimal_damping():
    steps = {mu: np.median(measured("damping", mu).steps) for mu in FAMILIES["damping"].values}

    best = min(steps, key=lambda mu: steps[mu])
    assert abs(math.log10(best / DEFAULT_DAMPING)) < 1 / 6  # of a decade: the values' distance


@pytest.mark.slow
def test_the_escape_time_is_logarithmic_in_the_distance_from_the_saddle():
    made = gaussian_instances(np.random.default_rng(1), count=COUNT)
    modes = solve_many(made.sources, made.targets, damping=2.0, spectrum=True).eigenvalues
    assert modes is not None
    near, far = (measured("start", distance) for distance in (1e-8, 1e-4))

    slope = (near.escape_times - far.escape_times) / math.log(1e4)

    np.testing.assert_allclose(slope, 1.0 / modes[:, 1, 0].real, rtol=0.02)
    np.testing.assert_allclose(near.escape_times, near.predicted_escape_times, rtol=0.03)


@pytest.mark.parametrize("damping", [0.1, 2.0, 10.0])
@pytest.mark.parametrize("growing", [0.3, 1.5])
def test_the_escape_is_told_by_the_linear_motion_from_rest(damping: float, growing: float):
    """x'' + mu x' = s (s + mu) x from rest; 0.6 is sin^2 of half the angle where it ends."""
    (time,) = sweeping.predicted_escape_times(np.array([growing]), damping, 1e-9)
    dying = -damping - growing
    grown = np.exp(growing * time) * dying - np.exp(dying * time) * growing
    turned = 1e-9 * grown / (dying - growing)

    assert math.sin(turned / 2) ** 2 == pytest.approx(0.6, rel=1e-6)
    assert sweeping.predicted_escape_times(np.array([growing]), damping, 3.6).tolist() == [0.0]


@pytest.mark.slow
def test_the_papers_rule_stops_at_a_saddle_and_certreg_does_not():
    near, far = measured("start", 1e-6), measured("start", 1e-2)

    assert near.lost.all()
    assert near.converged.all()
    assert not far.lost.any()


def test_lost_is_what_stops_more_than_90_degrees_from_the_optimum(monkeypatch):
    made = gaussian_instances(np.random.default_rng(2), count=5)
    solutions = solve_many(made.sources, made.targets)
    best = sweeping.rotation_matrices(solutions.quaternions[:, 0])
    angles = np.radians([0.0, 89.9, 90.1, 119.0, 179.0])
    turns = sweeping.rotation_matrices(
        np.column_stack([np.cos(angles / 2), np.sin(angles / 2), 0 * angles, 0 * angles])
    )
    ends = SimpleNamespace(rotations=turns @ best)
    monkeypatch.setattr(sweeping, "simulate_many", lambda *_, **__: ends)

    lost = sweeping._lost(bodies_of(made.sources, made.targets), solutions)

    assert lost.tolist() == [False, False, True, True, True]


@pytest.mark.slow
def test_the_margin_is_proportional_to_the_break_of_symmetry():
    for value in (1e-10, 1e-6, 1e-3):
        found = measured("symmetry", value)
        np.testing.assert_allclose(found.margins, found.predicted_margins, rtol=0.02 + 30 * value)
        assert found.four.all()


@pytest.mark.slow
def test_a_cube_that_is_not_moved_has_no_margin_but_rounding():
    found = measured("symmetry", 0.0)

    assert found.margins.max() < 1e-15
    assert not found.predicted_margins.any()


def test_what_doubles_do_not_decide_is_counted_exactly_and_what_stays_has_no_time(monkeypatch):
    """Of two instances one is left open, and its body does not leave the saddle."""

    def undecided(*arguments, **options):
        return replace(solve_many(*arguments, **options), decided=np.array([False, True]))

    def staying(bodies, integrator, **options):
        ends = simulate_many(bodies, integrator, **options)
        stays = np.array([integrator is Integrator.MIDPOINT, False])
        return replace(ends, status=np.where(stays, 0, ends.status))

    monkeypatch.setattr(sweeping, "solve_many", undecided)
    monkeypatch.setattr(sweeping, "simulate_many", staying)
    found = measured("damping", 2.8, 2)

    assert found.four.tolist() == [True, True]
    assert found.converged.tolist() == [True, True]
    assert np.isinf(found.escape_times).tolist() == [True, False]


def test_four_are_not_taken_for_granted_where_doubles_do_not_decide():
    """The cube onto itself, exactly: infinitely many equilibria."""
    sample = replace(FAMILIES["symmetry"].sample(np.random.default_rng(0), 0.0, 2))
    still = replace(sample, sources=np.array([CUBE] * 2), targets=np.array([CUBE] * 2))

    four = sweeping._four(still, np.array([True, False]))

    assert four.tolist() == [False, False]


@pytest.mark.slow
def test_near_a_mirror_image_times_grow_as_one_over_the_distance():
    near, far = measured("degeneracy", 0.01), measured("degeneracy", 0.1)

    np.testing.assert_allclose(near.margins, near.predicted_margins, rtol=1e-9)
    np.testing.assert_allclose(near.margins, 0.01 / 3.0, rtol=1e-9)
    assert 9.0 < np.median(near.escape_times) / np.median(far.escape_times) < 11.0
    np.testing.assert_allclose(near.escape_times, near.predicted_escape_times, rtol=0.06)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("points", "sigma"),
    [
        (100, 3.2),
        pytest.param(100, 0.0, marks=pytest.mark.long),
        pytest.param(1000, 10.0, marks=pytest.mark.long),
    ],
)
def test_the_margin_is_that_of_the_central_limit(points: int, sigma: float):
    count = 2000
    made = gaussian_instances(np.random.default_rng(3), points=points, sigma=sigma, count=count)
    margins = solve_many(made.sources, made.targets).margins

    told = limit_margin(points, sigma)

    assert abs((margins < told).mean() - 0.5) < 3 * 0.5 / math.sqrt(count) + 0.02


@pytest.mark.slow
@pytest.mark.parametrize("sigma", [0.0, 1.0])
def test_the_limit_is_the_median_of_random_instances(sigma: float):
    made = gaussian_instances(np.random.default_rng(0), points=1000, sigma=sigma, count=200)
    median = np.median(solve_many(made.sources, made.targets).margins)

    assert limit_margin(1000, sigma) == pytest.approx(median, rel=0.15)


@pytest.mark.slow
def test_the_limit_is_told_from_ten_points_on():
    told = [
        bool(np.isfinite(FAMILIES["points"].sample(np.random.default_rng(0), n, 2).margins).all())
        for n in (9.0, 10.0, 100.0)
    ]

    assert told == [False, True, True]


def test_zero_stands_a_quarter_of_the_axis_before_the_others():
    zero, least, *_, largest = np.log10(FAMILIES["noise"].places)

    assert FAMILIES["noise"].values[0] == 0.0
    assert least - zero == pytest.approx((largest - least) / 4)


@pytest.mark.slow
def test_the_limit_falls_as_one_over_the_root_of_the_points():
    assert limit_margin(10**6, 0.01) / limit_margin(10**4, 0.01) == pytest.approx(0.1, rel=0.02)


def test_the_margin_of_a_diagonal_is_that_of_its_singular_values():
    assert margin(np.diag([2.0, 1.0, -0.9])) == pytest.approx(2 * 0.1 / 6.0)
    assert margin(np.eye(3)) == pytest.approx(0.0, abs=1e-15)


# measuring


@pytest.mark.slow
def test_portions_are_of_one_stream_and_all_there():
    whole = measured("noise", 0.1, 12)
    family, rng = FAMILIES["noise"], np.random.default_rng(1)

    parts = measurements(family, 0.1, rng, 12, portion=500)

    assert [len(array) for array in (whole.steps, parts.steps, parts.four)] == [12] * 3
    assert parts.converged.all()


def test_of_large_clouds_there_are_fewer_instances():
    assert [instance_count(n, 200) for n in (3, 10_000, 100_000)] == [200, 200, 20]
    assert instance_count(100_000, 1) == 1
    assert instance_count(100_000, 2000) == 200


@pytest.mark.long
@pytest.mark.slow
def test_one_seed_gives_the_same_maps(found):
    family = replace(FAMILIES["noise"], values=(0.01,))

    one, other = (measurements(family, 0.01, np.random.default_rng(5), 4) for _ in range(2))

    for name in ("steps", "escape_times", "margins"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


# figures and files


@pytest.mark.slow
def test_every_family_has_a_figure_with_three_panels(shown, drawn):
    assert [drawing.name for drawing in drawn] == [f"map-{name}" for name in FAMILIES][: len(shown)]
    assert all(len(drawing.figure.axes) == len(QUANTITIES) for drawing in drawn)


def test_the_curves_are_medians_and_worsts_of_the_instances(shown, drawn):
    for one, drawing in zip(shown, drawn, strict=True):
        for panel, quantity in zip(drawing.figure.axes, QUANTITIES, strict=True):
            values = [getattr(each, quantity.name) for each in one.measurements]
            medians, worsts = (
                np.array([f(v) for v in values]) for f in (np.median, quantity.worst)
            )
            for line, expected in zip(panel.lines, (medians, worsts), strict=False):
                shown = np.asarray(line.get_ydata())
                np.testing.assert_array_equal(shown[~np.isnan(shown)], expected[expected > 0.0])
    assert QUANTITIES[2].worst(np.array([1.0, 2.0])) == 1.0


def test_theory_is_drawn_where_there_is_one(shown, drawn):
    for one, drawing in zip(shown, drawn, strict=True):
        for panel, quantity in zip(drawing.figure.axes, QUANTITIES, strict=True):
            told = one.curves(quantity).predicted
            labels = [line.get_label() for line in panel.lines]
            assert ("theory" in labels) == bool(np.isfinite(told).any())


def test_labels_are_whole_apart_and_large_enough(drawn):
    for drawing in drawn:
        renderer = drawing.figure._get_renderer()
        frame = drawing.figure.bbox.padded(0.5)
        texts = shown_texts(drawing.figure)
        boxes = [text.get_window_extent(renderer) for text in texts]
        for k, (text, box) in enumerate(zip(texts, boxes, strict=True)):
            whole = [frame.x0 <= box.x0, box.x1 <= frame.x1, frame.y0 <= box.y0, box.y1 <= frame.y1]
            assert all(whole), (drawing.name, text)
            assert text.get_fontsize() >= 7.5
            over = [texts[j].get_text() for j in range(k) if box.overlaps(boxes[j])]
            assert over == [], (drawing.name, text.get_text())


def test_captions_tell_the_counts(shown, drawn):
    for one, drawing in zip(shown, drawn, strict=True):
        assert drawing.caption.startswith(f"{len(one.measurements[0].steps)} random instances")
    total = sum(len(each.four) for each in shown[1].measurements)
    assert f"{total} of {total} instances" in drawn[1].caption


@pytest.mark.slow
def test_the_caption_of_the_start_tells_the_time_of_one_decade():
    """3 units a decade, but from the last value, which is outside of the linear part."""
    family, one = FAMILIES["start"], measured("start", 1e-2, 2)
    times = [10.0 - 3.0 * math.log10(value) for value in family.values[:-1]] + [0.5]
    sweep = Sweep(
        family=family,
        measurements=tuple(
            replace(
                one,
                value=value,
                escape_times=np.full(2, time),
                lost=np.array([value < 0.5e-5, value < 0.5e-3]),
            )
            for value, time in zip(family.values, times, strict=True)
        ),
    )
    found = tuple(replace(each, lost=np.zeros(2, dtype=np.bool_)) for each in sweep.measurements)

    assert "it needs 3.00 units of time more" in WORDS["start"](sweep)
    assert "stops every run at the saddle from 1·10⁻⁶ radians down" in WORDS["start"](sweep)
    assert WORDS["start"](replace(sweep, measurements=found)).endswith("slow is enough, holds.")


def told(name: str) -> Sweep:
    """Three instances a value, and no two numbers of a caption alike."""
    family = FAMILIES[name]
    every = tuple(
        Measurements(
            value=value,
            steps=np.array([1.0, 100.0 + (k - 4) ** 2, 1000.0 + (k - 6) ** 2]),
            escape_times=np.array([1.0, 10.0 + (k - 8) ** 2, 500.0 + (k - 2) ** 2]),
            margins=np.array([0.001 + 0.0001 * k, 0.1 + 0.01 * k, 0.5]),
            predicted_steps=np.array([2.0, 3.0, 7.0 + k]),
            predicted_escape_times=np.array([4.0, 5.0 + k, 900.0]),
            predicted_margins=np.array([0.0, 0.01 + 0.001 * k, 0.2]),
            converged=np.array([True, k > 2, k > 3]),
            lost=np.array([k == 0, False, k < 2]),
            four=np.array([True, True, k % 2 == 0]),
        )
        for k, value in enumerate(family.values)
    )
    return Sweep(family=family, measurements=every)


def test_captions_tell_the_numbers_of_the_values_that_they_name():
    at = {name: family.values for name, family in FAMILIES.items()}
    last = {name: len(values) - 1 for name, values in at.items()}
    parts = {
        "damping": (f"made at μ = {at['damping'][4]:g},", f"shortest at μ = {at['damping'][8]:g}:"),
        "noise": (
            f"the median of the steps, {100 + (last['noise'] - 4) ** 2:,},",
            f"worst run makes {1000 + (last['noise'] - 6) ** 2:,}. ",
            f"gap grows from 0.1 to {0.1 + 0.01 * last['noise']:.2g},",
        ),
        "points": (
            "short steps, up to 1,036 of them",
            f"to {0.1 + 0.01 * last['points']:.2g} at N = 10⁵",
        ),
        "symmetry": (),
        "degeneracy": (
            f"to 116 steps and 74 units of time at {at['degeneracy'][0]:g},",
            "ends 3 of",
        ),
    }
    for name, words in parts.items():
        text, total = WORDS[name](told(name)), 3 * (last[name] + 1)
        for part in words:
            assert part in text
        if name in {"noise", "points", "symmetry"}:
            assert f": {total - (last[name] + 1) // 2:,} of {total:,} instances." in text


def test_a_row_of_the_table_has_the_numbers_of_its_columns():
    rows = list(sweep_rows([told("noise")]))
    one = rows[3]
    columns = [f"{q.name}_{which}" for q in QUANTITIES for which in ("median", "worst", "told")]

    assert (one["map"], one["value"], one["instances"]) == ("noise", FAMILIES["noise"].values[3], 3)
    assert [one[name] for name in columns] == pytest.approx(
        [101.0, 1009.0, 3.0, 35.0, 501.0, 8.0, 0.13, 0.0013, 0.013]
    )
    assert [row["converged"] for row in rows[:5]] == [1, 1, 1, 2, 3]
    assert [row["lost_by_the_papers_rule"] for row in rows[:3]] == [2, 1, 0]
    assert [row["four_equilibria"] for row in rows[:2]] == [3, 2]


@pytest.mark.slow
def test_the_table_has_a_row_for_each_value_and_the_documents_fields(found):
    listed = list(csv.DictReader(io.StringIO(records_bytes(sweep_rows(found)).decode())))
    fields = SCHEMA["properties"]["maps"]["items"]["properties"]

    assert [(row["map"], float(row["value"])) for row in listed] == [
        (one.family.name, each.value) for one in found for each in one.measurements
    ]
    assert all(list(row) == list(fields) for row in listed)
    for row, values in zip(listed, sweep_rows(found), strict=True):
        assert float(row["steps_median"]) == values["steps_median"]
        assert (row["margins_told"] == "") == (values["margins_told"] is None)


@pytest.mark.slow
def test_a_run_that_never_escapes_is_no_number(found):
    last = found[0].measurements[-1]
    stuck = replace(last, escape_times=np.full_like(last.escape_times, math.inf))

    (row,) = sweep_rows([replace(found[0], measurements=(stuck,))])

    assert row["escape_times_median"] is None
    assert row["escape_times_worst"] is None


@pytest.mark.long
def test_the_command_writes_the_maps_when_asked(tmp_path, monkeypatch, found, drawn):
    monkeypatch.setattr("certreg.cli.reproducing.all_sweeps", lambda *_: found)
    monkeypatch.setattr("certreg.cli.reproducing.sweep_drawings", lambda _: drawn[:1])
    monkeypatch.setattr("certreg.cli.reproducing.paper_drawings", lambda _: ())
    monkeypatch.setattr("certreg.cli.reproducing.spring_counts", lambda *_: ())

    run = certreg("reproduce", "--runs", "1", "--no-proofs", "--beyond", "--out", tmp_path)

    assert run.code == 0
    assert (tmp_path / "maps.csv").read_bytes() == records_bytes(sweep_rows(found))
    assert (tmp_path / "figures" / "map-damping.png").exists()
    document = strict_json((tmp_path / "verdicts.json").read_bytes())
    assert Draft202012Validator(SCHEMA).is_valid(document)
    assert document["maps"] == list(sweep_rows(found))
