"""The encoder of the documents, and the results that say why a value is missing."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

import certreg
from certreg.report.encoding import ORDER, Noted, encoded
from certreg.results import OUT_OF_RANGE, Absent, Explained
from tests.strategies import ZOO, Specimen

LATE, NEVER = Absent("not yet"), Absent("not at all")


def explained(value: object, seen: list[Explained]) -> list[Explained]:
    """All results in a result that explain what they miss."""
    if isinstance(value, Explained):
        seen.append(value)
    if dataclasses.is_dataclass(value):
        for each in dataclasses.fields(value):
            explained(getattr(value, each.name), seen)
    if isinstance(value, tuple):
        for one in value:  # pyright: ignore[reportUnknownVariableType]
            explained(one, seen)  # pyright: ignore[reportUnknownArgumentType]
    return seen


def test_every_absent_is_a_null_with_its_reason_at_its_path():
    document = encoded({"a": LATE, "b": [1, {"c": NEVER}], "d": (2, ({"e": LATE},)), "f": None})
    assert document == {
        "a": None,
        "b": [1, {"c": None}],
        "d": [2, [{"e": None}]],
        "f": None,
        "reasons": {"a": "not yet", "b[1].c": "not at all", "d[1][0].e": "not yet"},
    }


def test_a_noted_value_stays_and_what_is_in_it_is_encoded():
    document = encoded({"a": Noted(False, "in doubt"), "b": Noted([1.0, NEVER], "gaps")})
    assert document["a"] is False
    assert document["b"] == [1.0, None]
    assert document["reasons"] == {"a": "in doubt", "b": "gaps", "b[1]": "not at all"}


def test_arrays_become_lists_and_complex_numbers_pairs():
    document = encoded({"real": np.eye(2), "complex": np.array([1 - 2j, 3j])})
    assert document["real"] == [[1.0, 0.0], [0.0, 1.0]]
    assert document["complex"] == [[1.0, -2.0], [0.0, 3.0]]


def test_reasons_stand_in_the_stated_order_wherever_the_values_stand():
    fields: dict[str, object] = {
        "pose": {"covariance": LATE},
        "objective": LATE,
        "equilibria": {"spurious": LATE, "complete": Noted(False, "in doubt"), "count": LATE},
        "relaxation": {"value": LATE},
        "simulation": LATE,
        "agreement": {"simulation_deg": LATE, "relaxation_deg": LATE},
        "objective_of_another": LATE,
    }
    expected = [
        *("objective", "pose.covariance"),
        *("equilibria.count", "equilibria.complete", "equilibria.spurious"),
        *("relaxation.value", "agreement.relaxation_deg"),
        *("simulation", "agreement.simulation_deg", "objective_of_another"),
    ]
    names, rng = list(fields), np.random.default_rng(5)
    for _ in range(20):
        names = [n for n in rng.permutation(names).tolist() if n != "objective_of_another"]
        names.append("objective_of_another")
        assert list(encoded({name: fields[name] for name in names})["reasons"]) == expected
    assert len(set(ORDER)) == len(ORDER)


@pytest.mark.one_in(4)
@pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)
def test_a_result_explains_exactly_what_is_none_and_can_be_missing(specimen: Specimen):
    registration = certreg.certify(specimen.problem, relaxation=False)
    solution = registration.solution
    later = {
        "covariance",
        "robustness",
        "labels",
        "predicted_rate",
        "decay_rate",
        "energy_left",
        "scales",
    }  # asked for, and so in no `absent`
    with_reasons: list[Any] = [registration, solution, solution.trajectory]
    for one in with_reasons:
        for name in later & set(dir(one)):
            assert isinstance(one.stated(name), Absent) == (getattr(one, name) is None)
    results = explained((registration, solution.equilibria, solution.fit), [])
    assert {type(one).__name__ for one in results} >= {
        "Registration",
        "LinearSolution",
        "Component",
    }
    for one in results:
        missing = {
            name for name in dir(one) if not name.startswith("_") and getattr(one, name) is None
        }
        unexplained = {
            "verdict",
            "doubt",
            "freedom",
            "trajectory",
            "untested",
        }  # no fields of a document
        assert missing - unexplained - later == set(one.absent)
        assert all(one.stated(name) is why for name, why in one.absent.items())


def test_a_value_that_is_there_has_no_reason():
    margin = certreg.equilibria(ZOO[0].problem).margin
    assert margin.stated("eigenvalue_gap") == margin.eigenvalue_gap
    assert margin.absent == {}
    gone = dataclasses.replace(margin, eigenvalue_gap=None, absent={"eigenvalue_gap": OUT_OF_RANGE})
    assert gone.stated("eigenvalue_gap") is OUT_OF_RANGE
    assert "absent" not in repr(gone)
    with pytest.raises(KeyError):
        dataclasses.replace(margin, eigenvalue_gap=None).stated("eigenvalue_gap")
