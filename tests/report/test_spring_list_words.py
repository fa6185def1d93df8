"""What a list of equilibria of general springs says where the optimum or the list is in doubt."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import product
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pytest
import spring_families
from commands import certreg, write_csv

from certreg import RegistrationProblem, equilibria, verify
from certreg.cli import dynamics
from certreg.objective.structure import Structure
from certreg.registration.enumeration import certified_list, enumerated
from certreg.registration.equilibria import spring_equilibria
from certreg.report.equilibria import Rests, spring_rests
from certreg.report.methods import COLUMNS, _row
from certreg.results import Absent, Guarantee

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.equilibrium.line_set import LineSet
    from certreg.registration.enumeration import Enumeration
    from certreg.registration.equilibria import SpringEquilibria


STATED = spring_families.statement(spring_families.instance(spring_families.LISTED[0], 0))
SPRINGS = COLUMNS[Structure.QUARTIC]
LEVEL = np.array([0.0, 0.0, 1.0])


def planes(count: int, seed: int, across: float = 1.0) -> RegistrationProblem:
    """Planes of random normals, with noise; across: a factor of the normals' third entries."""
    draw = np.random.default_rng(seed)
    source, normals = draw.normal(size=(2, count, 3))
    normals[:, 2] *= across
    target = source + 0.05 * draw.normal(size=(count, 3))
    return RegistrationProblem(source, target, normals=normals)


def searched(found: Enumeration[SpringEquilibria]) -> Rests:
    """What is said of a list with the searches for it."""
    return spring_rests(replace(found.equilibria, enumeration=found))


@cache
def six() -> Enumeration[SpringEquilibria]:
    return enumerated(RegistrationProblem(**STATED))


@cache
def wall(count: int = 10) -> Enumeration[SpringEquilibria]:
    """Planes of one normal: of one or two every rotation fits."""
    source = np.random.default_rng(7).normal(size=(count, 3))
    normals = np.tile(LEVEL, (count, 1))
    return enumerated(RegistrationProblem(source, source + 0.5, normals=normals))


def without(count: int) -> SpringEquilibria:
    """Of six planes the list without its first rows, in doubt."""
    (search,) = six().searches
    whole = cast("LineSet", search.critical)
    part = replace(
        whole, components=whole.components[count:], completeness=None, doubt="lines meet.", tied=0
    )
    return spring_equilibria(part, six().objective, RegistrationProblem(**STATED))


# --- which may be the optimum


def test_a_row_at_which_the_energy_falls_is_never_said_to_be_perhaps_the_optimum():
    found = without(2)
    told = str(found)

    assert found.components[0].morse_index == 1
    assert [part.optimal for part in found.components] == [False] * len(found.components)
    assert "may be optimal" not in told
    assert told.endswith(
        "None of these is the optimum: at the first, too, the energy falls in some direction. "
        "`certify` gives the best pose, and needs no list."
    )


def test_a_minimum_that_is_listed_first_may_be_the_optimum():
    found = without(1)
    told = str(found)

    assert [part.optimal for part in found.components][:2] == [None, False]
    assert "may be optimal" in told
    assert "None of these" not in told


@pytest.mark.long
def test_of_five_planes_no_row_that_is_listed_is_said_to_be_the_optimum():
    """Paths end somewhere on a curve of exact fits, by rounding here or there, or miss it."""
    found = equilibria(planes(5, 9))

    assert True not in [part.optimal for part in found.components]
    assert ("None of these is the optimum" in str(found)) == (
        found.components[0].morse_index is not None
    )


def test_where_the_optimum_is_not_decided_angles_are_to_the_first_row():
    found = six().equilibria
    document = searched(six()).document()
    rows = document["equilibria"]["components"]

    assert "  to row 1" in str(found)
    assert "to optimum" not in str(found)
    assert [part.angle_to_optimum for part in found.components] == [None] * len(rows)
    assert found.components[1].stated("angle_to_optimum") == Absent(
        "which equilibrium is the optimum is not decided"
    )
    assert [row["angle_to_optimum_deg"] for row in rows] == [None] * len(rows)
    assert rows[0]["angle_to_first_deg"] == 0.0 < rows[1]["angle_to_first_deg"]


def test_where_the_optimum_is_known_angles_are_to_it():
    found = enumerated(planes(12, 0)).equilibria

    assert found.unique
    assert all(part.angle_to_optimum == part.angle_to_first for part in found.components)
    assert "  to optimum" in str(found)


# --- energies


def test_an_energy_below_what_is_known_of_it_is_0_to_rounding():
    told = str(six().equilibria).splitlines()
    energies = [part.energy or 0.0 for part in six().equilibria.components]

    assert [line.count("0 to rounding") for line in told[2:5]] == [2, 2, 0]
    assert [part.rmse for part in six().equilibria.components][:2] == energies[:2] == [0.0, 0.0]
    assert energies == sorted(energies)


def test_of_a_row_that_shows_the_energy_of_the_first_it_is_said_by_how_much_it_is_higher():
    found = enumerated(planes(12, 0)).equilibria
    first, second, *_ = found.components
    near = replace(second, energy=first.energy, above=1.24e-16)
    told = str(replace(found, components=(first, near)))

    assert told.splitlines()[3].endswith("higher by 1.2e-16")
    assert "higher by" not in str(found)


@pytest.mark.slow
def test_a_bound_below_zero_is_told_as_zero_since_the_energy_is_a_sum_of_squares():
    certificate = certified_list(RegistrationProblem(**STATED), six().objective)

    assert certificate is not None
    assert certificate.body.claims.second.value < 0
    told = "\n".join(verify(certificate).theorems)
    assert "the objective is at least 0: not proved to be above R's." in told


# --- what the springs leave open


def test_of_one_wall_the_list_names_what_is_undetermined_and_that_there_are_infinitely_many():
    told = str(wall().equilibria)

    assert told.startswith("Equilibria (exact): infinitely many; none proved to be isolated.")
    assert told.endswith(
        "Rotation about the normal (0, 0, 1) is undetermined, and no spring resists a shift along "
        "(1, 0, 0), (0, 1, 0) or any mix of them."
    )


def test_of_a_corridor_the_list_says_that_a_shift_is_hardly_resisted():
    found = enumerated(planes(12, 0, across=1e-13)).equilibria
    told = str(found)

    assert found.complete
    assert "\nA shift along (0, 0, 1) is resisted by next to nothing: springs changed by " in told
    assert told.endswith("; the translations are of rounding as much as of the data.")


def test_where_all_is_resisted_nothing_is_said_of_it():
    document = searched(six()).document()

    assert document["equilibria"]["undetermined"] is None
    assert document["reasons"]["equilibria.undetermined"] == (
        "no shift or turn is known to be left open, or hardly resisted"
    )


# --- where no row, or every rotation, is listed


def test_a_list_without_rows_says_so_and_counts_nothing():
    (search,) = wall().searches
    bare = replace(search, critical=replace(cast("LineSet", search.critical), components=()))
    found = replace(wall().equilibria, components=())
    told = searched(
        replace(wall(), searches=(bare, bare), equilibria=found, comparison=None)
    ).words()

    assert told.startswith("Equilibria (exact): infinitely many; none is listed.")
    assert told.splitlines()[-1].split("  ")[1:3] == ["homotopy", "none"]
    assert told.endswith("in doubt")


def test_without_a_row_no_folder_of_poses_is_made(tmp_path, monkeypatch):
    monkeypatch.setattr(dynamics, "equilibrium_poses", lambda _: [])
    cloud, level = _clouds(tmp_path, 10)
    run = certreg("equilibria", cloud, cloud, "--normals", level, "--poses", tmp_path / "p")

    assert "no poses written to" in run.err
    assert run.err.endswith(": no equilibrium is listed\n")
    assert not (tmp_path / "p").exists()


def test_where_every_rotation_is_optimal_the_code_is_3_as_of_one_weight_per_pair(tmp_path):
    cloud, level = _clouds(tmp_path, 1)
    run = certreg("equilibria", cloud, cloud, "--normals", level, "--out", tmp_path / "list.json")

    assert run.code == 3
    assert "every rotation is an equilibrium, and every one is optimal." in run.out
    assert run.err.endswith(
        "only a list of 40 critical lines, complex ones included, has a certificate\n"
    )
    assert not (tmp_path / "list.json").exists()


def test_the_help_lists_the_codes():
    assert "4 the list is not proved complete" in certreg("equilibria", "--help").out


def _clouds(folder: Path, count: int) -> tuple[Path, Path]:
    """Points, and as many normals, all alike, as files."""
    points = np.random.default_rng(7).normal(size=(count, 3))
    np.save(folder / "n.npy", np.tile(LEVEL, (count, 1)))
    return write_csv(folder / "a.csv", points.tolist()), folder / "n.npy"


def test_a_method_is_known_as_well_as_the_least_known_of_its_equilibria():
    for one, other in product(Guarantee, repeat=2):
        parts = [SimpleNamespace(guarantee=kind, quaternion=(1, 0, 0, 0)) for kind in (one, other)]
        for complete in (False, True):
            critical: Any = SimpleNamespace(components=parts, indices=(0, 1), complete=complete)
            search: Any = SimpleNamespace(method="paths", seconds=0.5, critical=critical)
            doubt = "" if complete else ", in doubt"

            assert _row(search, six(), SPRINGS)[-1] == f"{min(one, other).label}{doubt}"


def test_a_method_is_told_with_how_many_equilibria_of_each_index_it_found():
    part = SimpleNamespace(guarantee=Guarantee.ENCLOSED, quaternion=(1, 0, 0, 0))
    critical: Any = SimpleNamespace(
        components=[part] * 5, indices=(0, 3, 1, 1, None), complete=False
    )
    search: Any = SimpleNamespace(method="paths", seconds=0.5, critical=critical, reason=None)

    assert _row(search, six(), SPRINGS) == (
        "paths",
        "5",
        "1 2 0 1",
        "500.00 ms",
        "enclosed, in doubt",
    )
    critical.components = []
    assert _row(search, six(), SPRINGS) == ("paths", "none", "-", "500.00 ms", "in doubt")
    search.critical = None
    assert _row(search, six(), SPRINGS) == ("paths", "-", "-", "500.00 ms", "undecided")
