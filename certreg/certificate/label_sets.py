"""Whether a set of pairs may be those within their bounds at an optimum: one 4x4 matrix decides."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.verify import (
    PRODUCTS,
    UNITS,
    bounded_pairs,
    form_at,
    form_of,
    positive_definite,
    twice,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from certreg.problem.problem import RegistrationProblem


def disproves_labels(
    problem: RegistrationProblem, within: Sequence[bool], quaternion: Sequence[int]
) -> bool:
    """Whether no optimum has just these pairs within their bounds, proved in integers.

    within: of each pair. quaternion: of a good rotation, any length. Where just these are within,
    the cost is the number of the others plus a form in p, |p| = 1: if that is above the cost of the
    good rotation for all p, no such rotation is optimal. False means not disproved, not proved.
    """
    rows, _ = bounded_pairs(problem.data_bytes()[-64 * problem.n :], problem.n)
    forms, one = [form_of(row)[0] for row in rows], 1 << UNITS
    norm = sum(c * c for c in quaternion)
    cost = sum(min(-(-form_at(k, quaternion) // norm) + 6, one) for k in forms)
    spare = cost - one * sum(not inside for inside in within)
    chosen = [form for form, inside in zip(forms, within, strict=True) if inside]
    sums = [sum(part) for part in zip(*chosen, strict=True)] or [0] * len(PRODUCTS)
    lifted = [k - spare * (i == j) for k, (i, j) in zip(sums, PRODUCTS, strict=True)]
    return positive_definite(twice(lifted))
