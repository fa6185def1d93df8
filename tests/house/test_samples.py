"""What `make test` leaves to `make test-long` is a part of each sample and never the whole."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from samples import drawn, leave_cases


class Case(SimpleNamespace):
    """What `leave_cases` knows of a test: its name and its marks."""

    def iter_markers(self, name: str) -> list[Any]:
        return [mark for mark in self.marks if mark.name == name]

    def get_closest_marker(self, name: str) -> Any:
        return next(iter(self.iter_markers(name)), None)

    def add_marker(self, name: str) -> None:
        self.marks.append(getattr(pytest.mark, name))


def left(cases: list[Case]) -> list[Case]:
    leave_cases(cases)  # pyright: ignore[reportArgumentType]
    return [case for case in cases if case.get_closest_marker("long")]


def family(name: str, count: int, *marks: Any) -> list[Case]:
    return [Case(nodeid=f"{name}[{k}]", marks=[*marks]) for k in range(count)]


@pytest.mark.parametrize(
    ("count", "one_in", "taken"), [(19, 3, 7), (2, 5, 1), (1, 2, 1), (8, 1, 8)]
)
def test_one_case_in_k_is_taken_and_at_least_one(count: int, one_in: int, taken: int):
    cases = family("a", count, pytest.mark.one_in(one_in).mark)

    assert len(left(cases)) == count - taken


def test_the_draw_is_ever_the_same_and_another_of_another_test():
    assert drawn("a", 30, 3) == drawn("a", 30, 3) == {2, 5, 8, 16, 17, 18, 19, 20, 21, 26}
    assert drawn("b", 30, 3) != drawn("a", 30, 3)


def test_cases_between_which_others_stand_are_one_sample_and_what_has_no_mark_is_left_alone():
    marked, free = family("a", 4, pytest.mark.one_in(4).mark), family("b", 4)
    mixed = [case for pair in zip(marked, free, strict=True) for case in pair]

    assert len(left(mixed)) == 3
    assert all(case in marked for case in left(mixed))
