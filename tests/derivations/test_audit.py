"""The audit of the paper: every row is as told, and every counterexample is one, exactly."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from certreg.results import Ruling, Verdict
from derivations import audit, book, counterexamples, spring_counterexamples
from derivations.audit import Finding, Row
from derivations.claims import stable_spurious
from derivations.counterexamples import Counterexample
from derivations.rationals import ExactCloud, ExactPlanes, add, rank, rank_modulo, solve

ROWS = audit.rows()
CARRIED = audit.carried_over()
DOUBTED = [row for row in (*ROWS, *CARRIED) if row.counterexample]
EXAMPLES = {
    name: value
    for file in (counterexamples, spring_counterexamples)
    for name, value in vars(file).items()
    if isinstance(value, Counterexample)
}
PROVED = Verdict(ruling=Ruling.PROVED, words="taken as proved")


def shifted(cloud: Any, by: tuple[int, int, int] = (1, 2, 3)) -> Any:
    """The cloud with its first source point moved."""
    first, *rest = cloud.source
    return replace(cloud, source=(add(first, by), *rest))


def row(number: str) -> Row:
    return next(row for row in ROWS if row.number == number)


def test_the_audit_has_the_fifteen_rows_and_no_number_twice():
    assert {int(row.number.rstrip("abcde")) for row in ROWS} == set(range(1, 16))
    assert max(Counter(row.number for row in ROWS).values()) == 1


def test_the_findings_are_these():
    found = {finding: [r.number for r in ROWS if r.finding is finding] for finding in Finding}

    assert found == {
        Finding.TRUE: ["1", "2", "4b", "5", "6b", "8a", "8b", "9b", "10", "11", "13a", "14", "15e"],
        Finding.TRUE_UNDER_A_CONDITION: ["3", "6c", "7", "12", "15a", "15b", "15c"],
        Finding.FALSE_AS_STATED: ["4a", "6a", "9a", "9c", "9d", "13b"],
        Finding.NOT_PROVED_HERE: ["15d"],
    }


def test_the_page_of_what_is_proved_counts_the_findings_as_they_are():
    page = Path(__file__).parents[2] / "docs" / "what-is-proved.md"
    words = " ".join(page.read_text("utf-8").split())
    count = Counter(row.finding for row in ROWS)

    assert f"Of the {len(ROWS)} claims that we count in that paper" in words
    assert f"{count[Finding.TRUE]} are true, " in words
    assert f"{count[Finding.TRUE_UNDER_A_CONDITION]} are true under a condition, " in words
    assert f"{count[Finding.FALSE_AS_STATED]} are false as stated" in words
    assert f"and {count[Finding.NOT_PROVED_HERE]} is not proved here" in words


def test_what_becomes_of_the_conjecture_where_springs_are_planes_is_no_claim_of_the_paper():
    assert [(row.number, row.finding) for row in CARRIED] == [
        ("S1", Finding.FALSE_AS_STATED),
        ("S2", Finding.FALSE_AS_STATED),
        ("S3", Finding.TRUE),
        ("S4", Finding.TRUE),
    ]
    assert not set(CARRIED) & set(ROWS)
    assert all("carried over" in row.place for row in CARRIED)


def test_planes_through_which_the_body_may_slide_have_no_energy():
    sliding = ExactPlanes(source=((1, 0, 0),), target=((0, 0, 0),), normals=((1, 0, 0),))

    with pytest.raises(ZeroDivisionError):
        sliding.energy(counterexamples.IDENTITY)


@pytest.mark.parametrize("row", CARRIED[:2], ids=lambda row: row.number)
def test_the_energies_of_planes_are_those_of_the_shipped_objective(row):
    (planes,) = row.counterexample.clouds
    q = (1, 2, 3, 4)

    assert planes.energy(counterexamples.rotation_of(q)) == planes.objective.energy(q) > 0


@pytest.mark.parametrize("far", [1, 2, 3])
def test_planes_hold_the_half_turns_where_the_points_on_them_are_far_enough_out(far):
    planes = stable_spurious.planes_of(far)
    points, normals = zip(*planes, strict=True)
    moved = replace(
        spring_counterexamples.STABLE,
        clouds=(ExactPlanes(source=points, target=points, normals=normals),),
    )

    assert moved.recheck().proved is (far > 1)


@pytest.mark.parametrize("row", DOUBTED, ids=lambda row: row.number)
def test_every_claim_that_is_not_true_as_stated_has_a_counterexample_that_is_one(row):
    assert row.recheck().proved, row.recheck()


@pytest.mark.parametrize("row", [r for r in ROWS if not r.counterexample], ids=lambda r: r.number)
def test_a_true_claim_has_no_counterexample_and_rests_on_the_book(row):
    assert row.recheck().ruling is Ruling.INCONCLUSIVE
    assert row.because


def test_the_claims_that_rows_rest_on_are_in_the_book():
    assert {name for row in (*ROWS, *CARRIED) for name in row.because} <= set(book.names())


def test_every_counterexample_of_the_file_is_used():
    used = [row.counterexample for row in DOUBTED]

    assert all(any(example is u for u in used) for example in EXAMPLES.values())


@pytest.mark.one_in(4)
@pytest.mark.parametrize("name", EXAMPLES)
def test_a_counterexample_with_one_point_moved_is_refused(name):
    example = EXAMPLES[name]

    for k, cloud in enumerate(example.clouds):
        mutated = (*example.clouds[:k], shifted(cloud), *example.clouds[k + 1 :])
        assert replace(example, clouds=mutated).recheck().ruling is Ruling.REFUTED


@pytest.mark.one_in(4)
@pytest.mark.parametrize("name", EXAMPLES)
def test_a_counterexample_that_tells_another_value_is_refused(name):
    example = EXAMPLES[name]

    for k, value in enumerate(example.expected):
        other = not value if isinstance(value, bool) else (value or 0) + 1
        told = (*example.expected[:k], other, *example.expected[k + 1 :])
        assert replace(example, expected=told).recheck().ruling is Ruling.REFUTED


def test_the_energy_formula_holds_at_a_rotation_so_that_row_3_is_about_the_shear():
    example = counterexamples.OFF_THE_ROTATIONS
    (cloud,) = example.clouds
    turned = counterexamples.ExactState(
        R=counterexamples.rotation_of((1, 2, 3, 4)), c=(1, 2, 3), v=(4, -1, 2), omega=(1, 0, -5)
    )
    drag = cloud.mass * counterexamples.squared_norm(turned.v)
    spin = counterexamples.dot(turned.omega, counterexamples.apply(cloud.inertia, turned.omega))

    assert counterexamples.energy_rate(cloud, turned) == -turned.damping * (drag + spin)


def test_a_cloud_that_is_not_flat_has_more_energy_far_out():
    solid = ExactCloud(source=counterexamples.ELLIPSOID, target=counterexamples.ELLIPSOID)

    assert replace(counterexamples.FLAT, clouds=(solid,)).recheck().ruling is Ruling.REFUTED


def test_targets_that_are_not_mirrored_have_one_optimum_only():
    plain = ExactCloud(source=counterexamples.TETRAHEDRON, target=counterexamples.TETRAHEDRON)

    assert replace(counterexamples.TWO_OPTIMA, clouds=(plain,)).recheck().ruling is Ruling.REFUTED


def test_a_square_onto_itself_is_not_a_counterexample_to_row_9a():
    example = counterexamples.SYMMETRIC_BUT_FINITE
    square = ExactCloud(source=counterexamples.SQUARE, target=counterexamples.SQUARE)

    assert square.classification.spurious is None
    assert replace(example, clouds=(square, *example.clouds[1:])).recheck().ruling is Ruling.REFUTED


def test_weights_can_break_a_symmetry():
    square = ExactCloud(source=counterexamples.SQUARE, target=counterexamples.SQUARE)
    weighted = replace(square, masses=(1, Fraction(1, 2), 1, 1))

    assert counterexamples.symmetries(square) == 8
    assert counterexamples.symmetries(weighted) == 2


def test_a_cloud_takes_no_floating_point_numbers():
    with pytest.raises(TypeError, match="no rational number"):
        ExactCloud(source=((0.5, 0, 0),), target=((1, 0, 0),))


def test_a_row_stands_only_if_the_claims_it_rests_on_are_proved():
    known = dict.fromkeys(row("3").because, PROVED)

    assert row("3").stands(known).proved
    assert row("3").stands({}).ruling is Ruling.INCONCLUSIVE
    lost = known | {row("3").because[0]: Verdict(ruling=Ruling.REFUTED, words="a step failed")}
    assert row("3").stands(lost).ruling is Ruling.INCONCLUSIVE
    assert row("1").stands(dict.fromkeys(row("1").because, PROVED)).proved


def test_a_true_claim_with_a_counterexample_is_refused():
    with pytest.raises(ValueError, match="unless the claim is true"):
        replace(row("1"), counterexample=counterexamples.FLAT)
    with pytest.raises(ValueError, match="unless the claim is true"):
        replace(row("4a"), counterexample=None)


def test_the_table_has_a_line_for_every_row_and_equal_cells():
    lines = audit.table().splitlines()

    assert len(lines) == len(ROWS) + 2
    assert {line.replace("\\|", "").count("|") for line in lines} == {8}


def test_the_linked_table_links_the_pages_of_the_proofs():
    assert "[properness](proofs/properness.md)" in audit.table(linked=True)
    assert "proofs/" not in audit.table()


def test_the_rational_helpers_are_right_on_small_matrices():
    assert rank([[1, 2], [2, 4]]) == 1
    assert rank([[0, 1, 0], [Fraction(1, 3), 0, 0]]) == 2
    assert rank_modulo([[1, 2], [2, 4]], 7) == 1
    assert rank_modulo([[2, 0], [0, 3]], 6) == 0
    assert rank_modulo([[5, 0, 1], [0, 3, 0], [1, 0, 7]], 2) == 2
    assert rank_modulo([[5, 0, 1], [0, 3, 0], [1, 0, 7]], 3) == 2
    assert solve(((2, 1, 0), (0, 1, 0), (0, 0, 4)), (3, 1, 2)) == (1, 1, Fraction(1, 2))
