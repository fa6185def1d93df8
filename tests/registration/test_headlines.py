"""No headline is stronger than its numbers, and its numbers bracket an exact oracle."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import mpmath
import numpy as np
import pytest
from commands import certreg, checked, write_csv
from mpmath.libmp import to_rational
from strategies import ZOO, random_rotation

from certreg.campaign.listing import read_listing
from certreg.campaign.pairs import PairCampaign
from certreg.certificate.bounds import PoseBounds
from certreg.dynamics.body import SimulationStatus
from certreg.exact.decimals import at_most
from certreg.exact.dyadic import rational_root_above, root_above
from certreg.geometry.so3 import rotation_matrix
from certreg.objective.isotropic import Isotropic
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem
from certreg.registration import headlines as listed
from certreg.registration.assessment import assess
from certreg.registration.certification import certify
from certreg.registration.headlines import HEADLINES, headline_of, headline_words
from certreg.report.document import result_document
from certreg.report.page import Report
from certreg.report.pages import html_page
from certreg.report.summary import registration_summary
from certreg.results import Limits, Optimality

if TYPE_CHECKING:
    from certreg.registration.result import Registration


SCHEMAS = Path(__file__).parents[2] / "certreg" / "report" / "schemas"
CLAIMS = Path(__file__).parents[2] / "derivations" / "claims"
KINDS = ("result", "assessment")
NAN, INFINITE = float("nan"), float("inf")


def attack(ratio: float = 1.0, offset: float = 0.0) -> RegistrationProblem:
    """A generic pair of clouds, the target `ratio` times as large, both far from the origin."""
    rng = np.random.default_rng(16)
    source = rng.normal(size=(12, 3))
    target = ratio * (source @ random_rotation(rng).T + 0.1 * rng.normal(size=(12, 3)))
    return RegistrationProblem(source + offset, target + offset)


def proof_of(problem: RegistrationProblem) -> Registration:
    return certify(problem, relaxation=False, simulation=False)


def energy_by_points(registration: Registration) -> Fraction:
    """The objective at the printed pose, summed over the points in rational numbers."""
    pose, problem = registration.pose, registration.problem
    q = [Fraction(entry) for entry in pose.quaternion_wxyz.tolist()]
    norm = sum((entry * entry for entry in q), start=Fraction(0))
    rows, shift = rotation_matrix(q), [Fraction(entry) for entry in pose.translation.tolist()]
    total = Fraction(0)
    points = zip(problem.source, problem.target, problem.weights, strict=True)
    for x, y, w in ((a.tolist(), b.tolist(), float(c)) for a, b, c in points):
        for row, t, end in zip(rows, shift, y, strict=True):
            turned = sum((a * Fraction(b) for a, b in zip(row, x, strict=True)), start=Fraction(0))
            moved = turned / norm + t
            total += Fraction(w) * (Fraction(end) - moved) ** 2
    return total


def minimum_and_range(problem: RegistrationProblem) -> tuple[Fraction, Fraction]:
    """By eigenvalues of 700 digits: the least objective, and the range over all rotations."""
    objective = Isotropic(exact_moments(problem))
    with mpmath.workdps(700):
        matrix = mpmath.matrix([[mpmath.mpf(e) for e in row] for row in objective.davenport])
        values = sorted(mpmath.eigsy(matrix, eigvals_only=True))
        top, bottom = (Fraction(*to_rational(v._mpf_)) for v in (values[3], values[0]))
    unit, spread = objective.moments.cross_unit, objective.moments.spread
    return spread - 2 * top * unit, 2 * (top - bottom) * unit


ATTACKS = [
    *((ratio, 0.0) for ratio in (1.0, 1e-100, 1e-150, 1e100, 1e125, 1e150)),
    *((1.0, offset) for offset in (1e8, 1e12, 1e15, 1e16)),
]


@pytest.mark.one_in(3)
@pytest.mark.parametrize(("ratio", "offset"), ATTACKS)
def test_a_headline_is_no_stronger_than_what_an_exact_oracle_says(ratio: float, offset: float):
    registration = proof_of(attack(ratio, offset))
    minimum, span = minimum_and_range(registration.problem)
    above = energy_by_points(registration) - minimum
    bounds = checked(registration.bounds)

    assert bounds.least_gap <= above * (1 + Fraction(1, 10**300)) <= bounds.greatest_gap
    assert bounds.least_range_squared <= span**2 <= 2 * bounds.least_range_squared
    assert checked(bounds.angle_upper) < 1e-14  # delta is small beside K, not beside the clouds
    assert above / span <= Fraction(checked(bounds.share_upper))
    certified = above / span <= Fraction(1, 10**6)
    assert (registration.status is Optimality.CERTIFIED) == certified
    assert registration.exit_code == (0 if certified else 4)
    words, document = registration_summary(registration), result_document(registration)
    assert words.startswith("CERTIFIED: " if certified else "BOUNDED: within ")
    assert document["optimality"]["status"] == ("certified" if certified else "bounded")
    told = "Not called certified: that asks for a proof that it is within 1e-06 of the range"
    assert (told in words) != certified
    assert "global optimum" not in words or certified


def test_the_attack_has_cases_on_both_sides():
    states = {proof_of(attack(*case)).status for case in ATTACKS}

    assert states == {Optimality.CERTIFIED, Optimality.BOUNDED}


@pytest.mark.one_in(4)
@pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)
def test_a_known_case_is_certified_and_its_headline_says_whether_it_is_unique(specimen):
    registration = proof_of(specimen.problem)
    unique = specimen.pattern[0] == 1

    assert (registration.status is Optimality.CERTIFIED) == unique
    assert headline_of(registration).good == (unique and not registration.fit.warnings)
    assert ("NOT UNIQUE" in headline_words(registration)) != unique


def test_limits_are_met_exactly_up_to_themselves():
    registration = proof_of(attack(offset=1e9))
    bounds = checked(registration.bounds)
    share, angle = checked(bounds.share_upper), checked(bounds.angle_upper)
    below = math.nextafter(share, 0.0), math.nextafter(angle, 0.0)
    smaller = math.nextafter(below[0], 0.0)  # the double below `share` may hold, too

    def status(gap: float, turn: float) -> Optimality:
        limited = replace(registration, limits=Limits(max_gap=gap, max_angle=turn))
        return limited.status

    assert status(share, angle) is Optimality.CERTIFIED
    assert status(smaller, angle) is Optimality.BOUNDED
    assert status(share, below[1]) is Optimality.BOUNDED


def test_a_unique_optimum_without_a_proved_angle_is_bounded():
    registration = proof_of(attack())
    bounds = replace(checked(registration.bounds), angle_upper=None)
    weak = replace(registration, bounds=bounds)

    assert weak.status is Optimality.BOUNDED
    assert headline_of(weak) is listed.BOUNDED_WITHOUT_ANGLE
    vacuous = replace(registration, bounds=replace(bounds, angle_upper=math.pi))
    assert headline_of(vacuous) is listed.BOUNDED_WITHOUT_ANGLE


def test_where_every_rotation_fits_the_translation_is_held_against_the_spread():
    """A point of the target at 1e16 / 3 is far from every double; the source is 1 wide."""
    source = np.random.default_rng(1).normal(size=(20, 3))
    registration = proof_of(RegistrationProblem(source, np.ones((20, 3)) * 1e16 / 3))
    bounds = checked(registration.bounds)
    judged = assess(registration.problem, registration.pose.rotation, registration.pose.translation)

    assert bounds.flat_energy == registration.solution.moments.spread
    assert (registration.status, registration.exit_code) == (Optimality.BOUNDED, 4)
    assert headline_words(registration).startswith("BOUNDED: within 0.")
    assert "every rotation fits equally, the translation does not" in headline_words(registration)
    assert "within 1e-06 of the clouds' own spread." in registration_summary(registration)
    assert not judged.headline.startswith("OPTIMAL")
    assert checked(judged.gap_upper) == bounds.gap_upper

    share = bounds.greatest_gap / bounds.flat_energy
    below, above = (math.nextafter(float(share), end) for end in (0.0, 1.0))
    assert not bounds.meet(Limits(max_gap=below), unique=False)
    assert bounds.meet(Limits(max_gap=above), unique=False)


@pytest.mark.parametrize("limit", [0.0, 1e-6, 1e-3, 0.5])
@pytest.mark.parametrize("unit", [Fraction(1, 10**9), Fraction(1), Fraction(10**9)])
@pytest.mark.parametrize("flat", [True, False])
def test_a_limit_is_of_the_energy_itself_in_any_unit(limit: float, unit: Fraction, *, flat: bool):
    """Of the range of energies; of the spread where that is zero. Just inside and just outside."""
    bounds = PoseBounds(
        least_gap=Fraction(0),
        greatest_gap=Fraction(limit) * unit,
        angle_upper=None if flat else 0.0,
        least_range_squared=Fraction(0) if flat else unit**2,
        flat_energy=unit if flat else Fraction(0),
    )
    beyond = replace(bounds, greatest_gap=bounds.greatest_gap + unit / 10**12)
    limits = Limits(max_gap=limit)

    assert bounds.meet(limits, unique=not flat)
    assert not beyond.meet(limits, unique=not flat)


@pytest.mark.parametrize("unit", [1.0, 2.0**54])
def test_a_single_pair_is_certified_in_any_unit(unit: float):
    registration = proof_of(RegistrationProblem([[0.1 * unit] * 3], [[0.7 * unit] * 3]))

    assert registration.status is Optimality.CERTIFIED_NOT_UNIQUE
    tight = replace(registration, limits=Limits(max_gap=0.0))
    assert headline_of(tight) is listed.BOUNDED_FLAT
    assert "of their distance from the origin, squared" in registration_summary(tight)


def test_a_vacuous_gap_is_no_certificate():
    registration = proof_of(attack())
    huge = replace(checked(registration.bounds), greatest_gap=Fraction(2**32768))
    vacuous = replace(registration, bounds=huge)

    assert vacuous.status is Optimality.BOUNDED
    assert "within 1.42e+9864 of the minimum" in headline_words(vacuous)
    assert "more than doubles hold times the range" in headline_words(vacuous)
    assert result_document(vacuous)["optimality"]["gap_share"] is None


def test_a_nearly_ambiguous_optimum_is_never_stamped_green():
    source = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    target = source * [1.0, 1.0, -(1.0 - 1e-5)]  # all but mirrored: d2 + d3 is 1e-5 of d1
    registration = proof_of(RegistrationProblem(source, target))

    assert registration.status is Optimality.CERTIFIED
    assert headline_of(registration) is listed.NEARLY_AMBIGUOUS
    assert not headline_of(registration).good


@pytest.mark.parametrize(("height", "kind"), [(-1.0 + 1e-5, "open"), (1.0, "good")])
def test_the_page_stamps_green_what_is_certified_and_far_from_ambiguous(height: float, kind: str):
    source = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    target = source * [1.0, 1.0, height]
    registration = proof_of(RegistrationProblem(source, target))
    page = html_page(Report.of(registration)).decode()
    stamps = re.findall(r'<p class="stamp (\w+)">([^<]*)</p>', page)

    assert stamps == [(kind, headline_of(registration).stamp)]
    assert registration.equilibria.nearly_ambiguous == (kind == "open")


def test_the_page_stamps_green_only_what_is_within_the_usual_limits():
    loose = replace(proof_of(attack(offset=1e16)), limits=Limits(max_gap=0.9))

    assert not headline_of(loose).good
    assert 'class="stamp open"' in html_page(Report.of(loose)).decode()


@pytest.mark.parametrize("value", [-1.0, NAN, INFINITE, 3.2])
def test_limits_that_make_no_sense_are_refused(value: float):
    for name in ("max_gap", "max_angle"):
        given: Any = {name: value}
        with pytest.raises(ValueError, match=name):
            certify(attack(), **given)


def test_the_limits_of_the_command_line_decide_the_code(tmp_path: Path):
    problem = attack(offset=1e9)
    clouds = [write_csv(tmp_path / f"{n}.csv", getattr(problem, n)) for n in ("source", "target")]
    plain = ("certify", *clouds, "--no-relaxation", "--no-simulation")

    assert certreg(*plain).code == 0
    tight = certreg(*plain, "--max-gap", "1e-30")
    assert tight.code == 4
    assert "within 1e-30 of the range of energies and 1e-05 radians" in tight.out
    assert certreg(*plain, "--max-angle", "1e-30").code == 4
    assert certreg(*plain, "--max-gap", "1e-30", "--json").document["optimality"]["limits"] == {
        "gap_share": 1e-30,
        "angle_rad": 1e-5,
    }
    for wrong in ("-1", "nan", "inf", "1", "1e80"):
        assert certreg(*plain, "--max-gap", wrong).code == 2
    vacuous = certreg(*plain, "--max-angle", "3.2")
    assert vacuous.code == 2
    assert "--max-angle is 3.2: give radians, from 0 to below 3.14159" in vacuous.err


def test_a_list_of_pairs_has_the_same_limits(tmp_path: Path):
    problem = attack(offset=1e9)
    names = [f"{n}.csv" for n in ("source", "target")]
    for name in names:
        write_csv(tmp_path / name, getattr(problem, name.removesuffix(".csv")))
    listing = tmp_path / "list.csv"
    listing.write_text(f"source,target\n{','.join(names)}\n", "utf-8")
    identities = set[str]()
    for limits, code in ((Limits(), 0), (Limits(max_angle=1e-30), 4), (Limits(max_gap=0.0), 4)):
        campaign = PairCampaign(listing=read_listing(listing), certificates=False, limits=limits)
        (task,) = campaign.tasks(done=())
        entry = json.loads(task.function(**task.arguments).content)
        identities.add(campaign.manifest().identity())

        assert entry["exit_code"] == code
        assert entry["optimality"]["status"] == ("bounded" if code else "certified")
    assert len(identities) == 3  # a folder of results keeps to one pair of limits


def test_a_root_rounded_up_is_above_the_root():
    rng = np.random.default_rng(3)
    for _ in range(200):
        value = Fraction(int(rng.integers(1, 2**62)), int(rng.integers(1, 2**62))) ** 2
        value *= Fraction(2) ** int(rng.integers(-600, 600))
        root = root_above(value)
        assert Fraction(root) ** 2 >= value
        near = rational_root_above(value + value**2)
        assert value + value**2 <= near**2 <= (value + value**2) * (1 + Fraction(1, 2**60))
        assert Fraction(math.nextafter(math.nextafter(root, 0.0), 0.0)) ** 2 < value
    assert root_above(Fraction(0)) == 0.0
    assert root_above(Fraction(4)) == 2.0
    assert root_above(Fraction(10) ** 700) == INFINITE


# The list of all headlines ----------------------------------------------------------------------

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "headlines.md"
ROW = re.compile(r"^\| `(?P<line>[A-Z].*)` \| (?P<code>\d) \| (?P<rests>.+) \|$", re.MULTILINE)
OTHERS = re.compile(r"(?<=\n)## Of pairs that may be wrong\n.*?(?=\n## )", re.DOTALL)
CLAIM = re.compile(r"\[(\w+)\]\(\.\./proofs/\1\.md\)")


def test_the_page_of_headlines_is_that_of_the_program():
    text = re.sub(OTHERS, "", PAGE.read_text("utf-8"))
    rows = {match["line"]: match for match in ROW.finditer(text)}
    assert list(rows) == [f"{one.stamp}: {one.words}" for one in HEADLINES]
    for headline, row in zip(HEADLINES, rows.values(), strict=True):
        names = re.findall(r"`([\w.]+)`|\[(\w+)\]", row["rests"])
        assert [field or claim for field, claim in names] == list(headline.rests_on)
        assert int(row["code"]) == headline.code


def test_the_page_says_of_every_brace_how_it_is_rounded():
    text = PAGE.read_text("utf-8").split("## The numbers in braces")[1].split("## ")[0]
    listed_braces = re.findall(r"`\{(\w+)\}`", text)
    braces = {name for one in HEADLINES for name in re.findall(r"\{(\w+)\}", one.words)}
    bounds = next(row for row in text.splitlines() if "`{gap}`" in row)

    assert sorted(listed_braces) == sorted(braces)
    assert re.findall(r"\{(\w+)\}", bounds) == ["gap", "share", "degrees"]
    assert at_most(1.001) == "1.01"  # rounded up
    far = proof_of(attack())
    shifted = assess(far.problem, far.equilibria.components[3].rotation)
    near = float(shifted.headline.split(": ")[1].split()[0])
    assert near == float(f"{math.degrees(checked(shifted.nearest_angle)):.2g}")  # to nearest


def test_every_headline_is_listed():
    defined = {value for value in vars(listed).values() if isinstance(value, listed.Headline)}
    of_poses = {one for pair in (*listed.OF_DATA.values(), listed.RULED_OUT) for one in pair}

    assert defined | of_poses == set(HEADLINES)
    assert len(HEADLINES) == len(set(HEADLINES))


def test_a_headline_rests_on_claims_and_figures_that_exist():
    schemas = [json.loads((SCHEMAS / f"certreg-{n}-1.json").read_text("utf-8")) for n in KINDS]
    for headline in HEADLINES:
        for name in headline.rests_on:
            figure = any(has_path(schema, name.split(".")) for schema in schemas)
            assert figure or (CLAIMS / f"{name}.py").exists(), name


def has_path(schema: Any, path: list[str]) -> bool:
    """Whether a schema has a key of that path."""
    if not path:
        return True
    options = [schema, *schema.get("anyOf", [])]
    inner = [one["properties"][path[0]] for one in options if path[0] in one.get("properties", {})]
    return any(has_path(one, path[1:]) for one in inner)


def test_the_first_lines_of_a_simulation_are_on_the_page():
    text = PAGE.read_text("utf-8")

    assert all(f"`{status.value}`" in text for status in SimulationStatus)


def test_green_is_only_what_is_certified_unique_and_far_from_a_tie():
    assert {one.stamp for one in HEADLINES if one.good} == {"CERTIFIED", "OPTIMAL TO ROUNDING"}


def test_no_headline_says_more_than_its_numbers():
    for headline in HEADLINES:
        assert "this is the global optimum" not in headline.words.lower()
        assert "no other" not in headline.words
        optimum = "global optimum" in headline.words
        assert not optimum or "to within the proved bounds" in headline.words
        assert not headline.good or " BUT " not in headline.stamp


def test_a_limit_that_was_moved_is_said_beside_the_headline():
    registration = replace(proof_of(attack(offset=1e16)), limits=Limits(max_gap=0.9))

    words = registration_summary(registration)
    flat = proof_of(RegistrationProblem([[0.1] * 3], [[1e3] * 3]))
    line = np.outer(np.arange(4.0), [1.0, 2.0, 3.0])
    rod = proof_of(RegistrationProblem(line, line))

    assert registration.status is Optimality.CERTIFIED
    share = listed.share_words(checked(registration.bounds))
    first, second = words.splitlines()[:2]
    assert first.startswith("CERTIFIED WITHIN THE LIMITS GIVEN: within ")
    assert share in first
    assert "optimum." in first
    assert "global optimum" not in words
    assert second.startswith("Certified means here within 0.9 of the range of energies")
    for found, headline in (
        (flat, listed.WITHIN_LIMITS_FLAT),
        (rod, listed.WITHIN_LIMITS_NOT_UNIQUE),
    ):
        bounds = checked(found.bounds)
        unit = Fraction(math.sqrt(bounds.least_range_squared)) or bounds.flat_energy
        wide = replace(bounds, greatest_gap=unit / 2)
        given = replace(found, bounds=wide, limits=Limits(max_gap=0.99))
        assert headline_of(given) is headline
        assert given.exit_code == headline.code == 3
