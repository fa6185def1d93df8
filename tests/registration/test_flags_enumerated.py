"""Flags that say what is proved: each on either side of equality, by enumeration."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import product
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from certreg.certificate import basin as basins
from certreg.certificate.basin import Barrier, barrier_of, basin_of_springs
from certreg.certificate.producing_consensus import UNDECIDED, ProvedConsensus
from certreg.equilibrium.breaking import Labels
from certreg.equilibrium.equilibrium_set import WEAK_MARGIN, EquilibriumSet
from certreg.equilibrium.line_batch import QuarticSolutions
from certreg.equilibrium.line_set import Finiteness, LineSet
from certreg.objective.classification import Classification
from certreg.registration import headlines
from certreg.registration.breaking import BreakingEquilibria, BreakingEquilibrium, SimulatedBreaking
from certreg.registration.equilibria import (
    SAME_ENERGY,
    TIED,
    ScaledEquilibria,
    SpringEquilibria,
    SpringEquilibrium,
    _margin,
    _optimal,
)
from certreg.registration.findings import Findings
from certreg.registration.label_assessment import (
    KeptPairs,
    LabelAssessment,
    LabelsVerdict,
    TruncatedLabels,
)
from certreg.registration.labelled import (
    ConsensusRegistration,
    LabelledRegistration,
    TruncatedRegistration,
)
from certreg.registration.pair_words import ranges_words
from certreg.registration.quartic import QuarticSolution
from certreg.registration.result import Registration
from certreg.registration.valley import SimulatedSprings
from certreg.results import Absent, ComponentKind, Guarantee, Limits, Optimality, Ruling

LITTLE = Fraction(1, 10**30)
BOTH = (False, True)
CODES = {
    Optimality.CERTIFIED: 0,
    Optimality.CERTIFIED_NOT_UNIQUE: 3,
    Optimality.BOUNDED: 4,
    Optimality.NOT_CERTIFIED: 4,
}


def asked(kind: type, name: str, /, **fields: Any) -> Any:
    """A property of something with these fields."""
    return getattr(kind, name).fget(SimpleNamespace(**fields))


def test_a_breaking_equilibrium_is_stable_where_it_is_proved_a_minimum_and_a_point():
    for labels, index, kind in product(Labels, range(3), ComponentKind):
        stable = asked(BreakingEquilibrium, "stable", labels=labels, morse_index=index, kind=kind)
        assert stable == (labels is Labels.PROVED and index == 0 and kind is ComponentKind.POINT)
        end = SimpleNamespace(labels=labels)
        assert asked(SimulatedBreaking, "self_consistent", end=end) == (labels is Labels.PROVED)
    assert not asked(SimulatedBreaking, "self_consistent", end=None)


def test_a_list_of_breaking_springs_is_complete_where_all_that_is_doubtful_is_a_tie():
    for one, other in product(Labels, repeat=2):
        doubtful = [SimpleNamespace(labels=labels) for labels in (one, other)]
        complete = asked(BreakingEquilibria, "complete", doubtful=doubtful)

        assert complete == (one is other is Labels.TIED)


def test_a_label_that_is_open_leaves_a_consensus_undecided():
    for labels in product(("inlier", "outlier", UNDECIDED), repeat=3):
        found = SimpleNamespace(labels=labels)
        decided = asked(ProvedConsensus, "decided", labels=labels)

        assert decided == (UNDECIDED not in labels)
        found.upper = 7
        assert asked(ConsensusRegistration, "upper", found=found) == 7
    for labels in product(("inlier", "outlier", "undecided"), repeat=3):
        decided = asked(LabelledRegistration, "labels_unique", labels=labels)
        assert decided == ("undecided" not in labels)


def test_a_consensus_with_open_labels_ends_with_3_at_the_maximum_and_with_4_below_it():
    for sure, upper, status in product(BOTH, (7, 8), Optimality):
        fit = SimpleNamespace(exit_code=CODES[status])
        code = asked(
            ConsensusRegistration, "exit_code", labels_unique=sure, lower=7, upper=upper, fit=fit
        )

        own = 0 if sure else 3 if upper == 7 else 4
        assert code == max(own, CODES[status])


@pytest.mark.parametrize("unique", BOTH)
@pytest.mark.parametrize("labelled", BOTH)
@pytest.mark.parametrize("angle", [None, 0.5, math.nextafter(0.5, 1.0)])
@pytest.mark.parametrize("share", [0.25, math.nextafter(0.25, 1.0)])
def test_truncated_squares_are_certified_within_both_limits(unique, labelled, angle, share):
    worth = SimpleNamespace(angle=angle, share=share)
    fields: dict[str, Any] = {
        "certificate": SimpleNamespace(body=None),
        "verdict": SimpleNamespace(worth=worth),
        "fit": SimpleNamespace(limits=Limits(max_gap=0.25, max_angle=0.5)),
        "labels_unique": labelled,
        "unique": unique,
    }
    near = not unique or angle == 0.5

    certified = asked(TruncatedRegistration, "certified", **fields)
    assert certified == (labelled and near and share == 0.25)
    assert not asked(TruncatedRegistration, "certified", **fields | {"certificate": None})
    nothing = SimpleNamespace(worth=None)
    assert not asked(TruncatedRegistration, "certified", **fields | {"verdict": nothing})
    code = asked(TruncatedRegistration, "exit_code", certified=certified, unique=unique)
    assert code == (4 if not certified else 0 if unique else 3)


def test_what_no_certificate_says_of_truncated_squares_is_not_said():
    assert not asked(TruncatedRegistration, "unique", certificate=None)
    assert asked(TruncatedRegistration, "gap", certificate=None) is None
    for unique in BOTH:
        body = SimpleNamespace(claims=SimpleNamespace(unique=unique), gap=Fraction(1, 3))
        certificate = SimpleNamespace(body=body)

        assert asked(TruncatedRegistration, "unique", certificate=certificate) == unique
        gap = asked(TruncatedRegistration, "gap", certificate=certificate)
        assert math.nextafter(gap, 0.0) < Fraction(1, 3) <= gap


def test_labels_that_differ_are_those_of_the_other_side():
    for words in product(("inlier", "outlier", "undecided"), repeat=3):
        for kept in product(BOTH, repeat=3):
            rows = [row for row in range(3) if kept[row]]
            found = asked(
                TruncatedLabels, "differing", rows=rows, optimum=SimpleNamespace(labels=words)
            )

            assert found == tuple(
                row for row in range(3) if words[row] == ("outlier" if kept[row] else "inlier")
            )
    codes = {LabelsVerdict.CONSISTENT: 0, LabelsVerdict.REFUTED: 1, LabelsVerdict.UNDECIDED: 4}
    for verdict, code in codes.items():
        assert asked(LabelAssessment, "exit_code", verdict=verdict) == code


def test_kept_pairs_are_consistent_where_a_motion_is_shown_and_refuted_where_none_is_possible():
    for refuted, witness in product(((), (0, 1), (0, 2, 3)), (None, object())):
        motion = SimpleNamespace(refuted=refuted, witness=witness)
        verdict = asked(KeptPairs, "verdict", motion=motion)

        expected = LabelsVerdict.UNDECIDED if witness is None else LabelsVerdict.CONSISTENT
        assert verdict is (LabelsVerdict.REFUTED if refuted else expected)
        for sets, most in product((5, 6, 7), (None, 4, 6, 8)):
            upper = asked(
                KeptPairs,
                "upper",
                motion=motion,
                sets=sets,
                most=None if most is None else SimpleNamespace(upper=most),
                problem=SimpleNamespace(n=6),
            )
            assert upper == min(6 if most is None else most, sets, 5 if refuted else 6)


def test_kept_pairs_are_the_inliers_where_all_is_decided_and_just_these_are_met():
    assert not asked(KeptPairs, "unique", most=None, rows=(0, 1))
    for decided, met in product(BOTH, ((0, 1), (0, 2))):
        most = SimpleNamespace(decided=decided, met=met)
        assert asked(KeptPairs, "unique", most=most, rows=(0, 1)) == (decided and met == (0, 1))


def test_many_lists_of_springs_are_enclosed_where_each_is_decided_and_proved():
    """Whatever was found: that all forty paths of each ended apart is no proof."""
    for flags in product(BOTH, repeat=4):
        decided, found = np.array(flags[:2]), np.array(flags[2:])
        for lists in (None, (object(), object())):
            guarantee = asked(
                QuarticSolutions, "guarantee", decided=decided, found=found, lists=lists
            )

            proved = all(flags[:2]) and lists is not None
            assert guarantee is (Guarantee.ENCLOSED if proved else Guarantee.NUMERICAL)


def test_equilibria_of_springs_are_counted_where_the_list_is_complete_and_all_are_points():
    for kinds in product(ComponentKind, repeat=2):
        parts = [SimpleNamespace(kind=kind) for kind in kinds]
        for complete in BOTH:
            count = asked(SpringEquilibria, "count", components=parts, complete=complete)
            alone = all(kind is ComponentKind.POINT for kind in kinds)

            assert count == (2 if complete and alone else None)
    for count, kind, tied in product((None, 8), Finiteness, (0, 1, 2)):
        fields = {"count": count, "finiteness": kind, "tied": tied}
        whole = count == 8 and kind is Finiteness.FORTY

        assert asked(SpringEquilibria, "count_complex", **fields) == (40 if whole else None)
        assert asked(SpringEquilibria, "unique", **fields) == (count == 8 and tied == 1)
        for complete in BOTH:
            constant = asked(SpringEquilibria, "all_optimal", complete=complete, finiteness=kind)
            assert constant == (complete and kind is Finiteness.CONSTANT)
    for index, stable in ((None, None), (0, True), (1, False), (-1, False)):
        assert asked(SpringEquilibrium, "stable", morse_index=index) is stable


def line_set(*parts: Any, complete: bool = True, tied: int = 1) -> Any:
    return SimpleNamespace(components=parts, complete=complete, tied=tied)


def part(value: int = 0, index: int | None = 0, *, proved: bool = True) -> Any:
    guarantee = Guarantee.ENCLOSED if proved else Guarantee.NUMERICAL
    return SimpleNamespace(value=Fraction(value), index=index, guarantee=guarantee)


def test_an_equilibrium_is_the_best_where_the_whole_list_says_so():
    least, most = Fraction(0), Fraction(3)
    edge = SAME_ENERGY * most

    def optimal(of: Any, excess: Fraction = least) -> Any:
        return _optimal(of, 0, excess, most)

    assert optimal(line_set(part())) is True
    assert isinstance(optimal(line_set(part(), tied=2)), Absent)
    assert isinstance(optimal(line_set(part(), tied=0)), Absent)
    assert isinstance(optimal(line_set(part(), complete=False)), Absent)
    assert optimal(line_set(part(index=1))) is False
    assert optimal(line_set(part()), edge) is True
    assert optimal(line_set(part()), edge + LITTLE) is False
    unsure = line_set(part(proved=False), complete=False)
    assert optimal(unsure) != optimal(line_set(part(), complete=False))
    assert isinstance(optimal(unsure, most), Absent)
    for tied, second in ((1, False), (2, TIED), (3, TIED)):
        pair = line_set(part(), part(), tied=tied)
        assert _optimal(pair, 1, least, most) is second


def test_the_margin_of_springs_is_the_share_between_the_best_and_the_second():
    assert _margin(line_set(part(1), part(2), part(5))) == 0.25
    assert _margin(line_set(part(1), part(5))) == 1.0
    assert _margin(line_set(part(1), part(2), tied=2)) is None
    assert _margin(line_set(part(1))) is None
    assert _margin(line_set(part(2), part(1), part(3))) == 0.0  # equal in the digits of the list
    found = [part(proved=False), part(), part(proved=False), part()]
    assert asked(LineSet, "separated", components=found) == 2


def test_one_rotation_is_optimal_as_far_as_a_certificate_says():
    for claimed, moves in product((None, False, True), BOTH):
        certificate = SimpleNamespace(body=SimpleNamespace(claims=SimpleNamespace(unique=claimed)))
        freedom = SimpleNamespace(moves_optimum=moves, translations=())
        rotation = asked(
            QuarticSolution, "unique_rotation", certificate=certificate, freedom=freedom
        )

        assert rotation is (claimed if claimed is not None else False if moves else None)
        without = asked(QuarticSolution, "unique_rotation", certificate=None, freedom=freedom)
        assert without is (False if moves else None)
        for free in ((), (1,)):
            freedom = SimpleNamespace(translations=free)
            unique = asked(QuarticSolution, "unique", freedom=freedom, unique_rotation=rotation)
            assert unique is (False if free else rotation)


def test_a_pose_is_elsewhere_at_a_worse_equilibrium_and_near_within_a_proved_angle():
    settings: Any = SimpleNamespace(near_optimal_angle=0.5)
    assert not asked(Findings, "is_elsewhere", place=SimpleNamespace(rest=None))
    for worse in BOTH:
        rest = SimpleNamespace(worse=worse)
        assert asked(Findings, "is_elsewhere", place=SimpleNamespace(rest=rest)) == worse
    for unique, angle in product((None, False, True), (None, 0.5, math.nextafter(0.5, 1.0))):
        pose: Any = SimpleNamespace(unique=unique, bounds=SimpleNamespace(angle_upper=angle))
        assert Findings.is_near(pose, settings) == (unique is not None or angle == 0.5)


def test_a_simulation_converged_where_it_rests_at_what_is_as_good():
    for rest, good in product(BOTH, (None, False, True)):
        converged = asked(SimulatedSprings, "converged", at_rest=rest, as_good=good)
        assert converged == (rest and good is True)


def test_a_certified_pose_is_unique_or_one_of_several_or_bounded():
    for proved, met, unique, turned in product(BOTH, BOTH, (None, False, True), (None, True)):
        limits: list[bool] = []

        def meet(_: Any, *, unique: bool, met: bool = met, limits: list[bool] = limits) -> bool:
            limits.append(unique)
            return met

        fields: dict[str, Any] = {
            "verdict": SimpleNamespace(proved=proved),
            "bounds": SimpleNamespace(meet=meet),
            "solution": SimpleNamespace(unique_rotation=turned),
            "unique": unique,
            "limits": None,
        }
        status = asked(Registration, "status", **fields)
        good = Optimality.CERTIFIED if unique else Optimality.CERTIFIED_NOT_UNIQUE
        bounded = Optimality.BOUNDED if unique is None or not met else good

        assert status is (bounded if proved else Optimality.NOT_CERTIFIED)
        assert limits in ([], [turned is True])
        for missing in ("verdict", "bounds"):
            lost = asked(Registration, "status", **fields | {missing: None})
            assert lost is Optimality.NOT_CERTIFIED


def test_equilibria_with_a_scale_are_as_many_as_those_without():
    for kinds in product(ComponentKind, repeat=2):
        parts = [SimpleNamespace(component=SimpleNamespace(kind=kind)) for kind in kinds]
        finite = asked(ScaledEquilibria, "finite", components=parts)

        assert finite == all(kind.dimension == 0 for kind in kinds)
        count = asked(ScaledEquilibria, "count", components=parts, finite=finite)
        assert count == (2 if finite else None)


@pytest.mark.parametrize("beside", [-LITTLE, Fraction(0), LITTLE])
def test_an_interval_of_scales_and_its_words_are_rounded_outwards(beside: Fraction):
    low, high = (Fraction(end) + beside for end in (0.1, 0.75))
    body = SimpleNamespace(scales=(low, high))
    found = asked(ConsensusRegistration, "scale_interval", certificate=SimpleNamespace(body=body))

    assert found[0] <= low < math.nextafter(found[0], 1.0)
    assert math.nextafter(found[1], 0.0) < high <= found[1]
    words = ranges_words([(0.1234567891, 0.2345678912), (0.5, math.inf)])
    ends = [float(word) for word in words.split() if word[0].isdigit()]
    assert words.split()[0::3][0] == "from"
    assert ends[0] <= 0.1234567891
    assert ends[1] >= 0.2345678912
    assert ends[2] == 0.5
    assert words.endswith(" and from 0.5 on")


def test_more_than_three_ranges_are_counted():
    ranges = [(float(k), k + 0.5) for k in range(5)]

    assert ranges_words(ranges[:1]) == "from 0 to 0.5"
    assert ranges_words(ranges[:3]) == "from 0 to 0.5, from 1 to 1.5 and from 2 to 2.5"
    assert ranges_words(ranges[:4]) == "from 0 to 0.5, from 1 to 1.5 and in 2 other ranges"
    assert ranges_words(ranges) == "from 0 to 0.5, from 1 to 1.5 and in 3 other ranges"


PATTERNS = [(1, 1, 1, 1), (1, 1, 2), (1, 2, 1), (2, 1, 1), (2, 2), (1, 3), (3, 1), (4,)]


@pytest.mark.parametrize("pattern", PATTERNS)
def test_a_pattern_says_whether_optimum_and_equilibria_are_alone(pattern: tuple[int, ...]):
    finite = asked(Classification, "finite", pattern=pattern)

    assert asked(Classification, "unique", pattern=pattern) == (pattern[0] == 1)
    assert finite == (pattern == (1, 1, 1, 1))
    for definite in BOTH:
        unstable = asked(Classification, "unstable", indices=(0, 1), inertia_definite=definite)
        assert unstable == ((0, 1) if definite else None)
    classification = SimpleNamespace(finite=finite, unique=pattern[0] == 1)
    parts = list(pattern)
    count = asked(EquilibriumSet, "count", components=parts, classification=classification)
    assert count == (4 if finite else None)


def test_a_margin_is_narrow_below_its_limit_and_where_the_optimum_is_unique():
    for unique, relative, out in product(
        BOTH, (WEAK_MARGIN, math.nextafter(WEAK_MARGIN, 0.0)), BOTH
    ):
        classification = SimpleNamespace(unique=unique)
        margin = SimpleNamespace(relative=relative)
        narrow = asked(EquilibriumSet, "narrow", classification=classification, margin=margin)

        assert narrow == (unique and relative < WEAK_MARGIN)
        assert asked(EquilibriumSet, "nearly_ambiguous", narrow=narrow, next_ruled_out=out) == (
            narrow and not out
        )


def test_the_barrier_is_between_what_is_claimed_and_the_second_with_the_width_of_its_box():
    objective: Any = SimpleNamespace(energy=Fraction, oscillation=Fraction(3))

    def barrier(unique: Any, *quaternions: int) -> Barrier:
        second = SimpleNamespace(value=Fraction(6))
        body: Any = SimpleNamespace(
            claims=SimpleNamespace(unique=unique, second=second), quaternions=quaternions, bits=5
        )
        return barrier_of(objective, body)

    assert barrier(True, 1, 7) == barrier(True, 1, 7, 9)
    assert barrier(True, 1, 7) == Barrier(lower=Fraction(6), upper=7 + Fraction(48, 32))
    assert barrier(True, 1) == barrier(False, 1, 7) == barrier(None, 1, 7) == Barrier(lower=None)


@pytest.mark.parametrize(
    ("energy", "ruling"),
    [
        (6 - LITTLE, Ruling.PROVED),
        (Fraction(6), Ruling.INCONCLUSIVE),
        (8 - LITTLE, Ruling.INCONCLUSIVE),
        (Fraction(8), Ruling.REFUTED),
        (8 + LITTLE, Ruling.REFUTED),
    ],
)
def test_a_basin_is_proved_below_the_barrier_and_refuted_from_its_top_on(
    monkeypatch, energy: Fraction, ruling: Ruling
):
    monkeypatch.setattr(basins, "state_energy", lambda *_: energy)

    def basin(lower: Any, upper: Any, *, free: Any = (), size: int = 2) -> Ruling:
        scatter = [[int(i == j < size) for j in range(3)] for i in range(3)]
        objective: Any = SimpleNamespace(free_translations=free, mass_scatter=scatter)
        state: Any = None
        barrier = Barrier(lower=lower, upper=upper)
        return basin_of_springs(objective, barrier, state).ruling

    lower, upper = Fraction(6), Fraction(8)
    assert basin(lower, upper) is basin(lower, upper, size=3) is ruling
    assert basin(None, upper) is Ruling.INCONCLUSIVE
    assert basin(lower, upper, free=(1,)) is Ruling.INCONCLUSIVE
    assert basin(lower, upper, size=1) is Ruling.INCONCLUSIVE
    above = Ruling.PROVED if energy < 6 else Ruling.INCONCLUSIVE
    assert basin(lower, None) is above


def test_a_card_is_good_where_all_that_it_says_is_proved_and_nothing_is_against_it():
    for code, against in product((0, 3, 4), (None, "THE POSE IS NOT UNIQUE")):
        good = asked(LabelledRegistration, "good", exit_code=code, against=against)
        assert good == (code == 0 and against is None)


def test_the_usual_limits_are_met_by_the_angle_too_where_one_rotation_is_optimal():
    for turned, met in product((None, False, True), BOTH):
        seen: list[tuple[Limits, bool]] = []

        def meet(limits: Limits, *, unique: bool, seen: Any = seen, met: bool = met) -> bool:
            seen.append((limits, unique))
            return met

        bounds = SimpleNamespace(meet=meet)
        solution = SimpleNamespace(unique_rotation=turned)
        registration: Any = SimpleNamespace(bounds=bounds, solution=solution)

        assert headlines._meets_usual(registration) == met
        assert seen == [(Limits(), turned is True)]
    unproved: Any = SimpleNamespace(bounds=None, solution=solution)
    assert not headlines._meets_usual(unproved)


def test_a_met_row_is_broken_where_its_residual_is_beyond_its_bound():
    sizes = (math.nextafter(0.5, 0.0), 0.5, math.nextafter(0.5, 1.0))
    for residuals, met in product(product(sizes, repeat=3), ((0, 1, 2), (0, 2))):
        broken = asked(
            ConsensusRegistration,
            "broken",
            residuals=np.array(residuals),
            problem=SimpleNamespace(bounds=np.full(3, 0.5)),
            inliers=np.array(met),
        )
        assert broken == tuple(row for row in met if residuals[row] > 0.5)


def test_a_turn_is_loose_by_residuals_where_they_are_neither_warned_of_nor_rounding():
    edges = (0.4, math.nextafter(0.4, 1.0))
    for estimated, warned, rounded, sigma in product(BOTH, BOTH, BOTH, edges):
        registration: Any = SimpleNamespace(
            covariance=SimpleNamespace(estimated=estimated, loosest_sigma=sigma),
            fit=SimpleNamespace(warnings=("one",) * warned, rounded=rounded),
        )
        told = not estimated or not (warned or rounded)
        assert headlines.is_loose(registration) == (told and sigma > 0.4)
    nothing: Any = SimpleNamespace(covariance=None, fit=None)
    assert not headlines.is_loose(nothing)
