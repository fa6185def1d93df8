"""Exit codes: of several the one that must not be overlooked."""

from __future__ import annotations

from itertools import product

from certreg.registration.exit_codes import worst


def test_the_worst_code_is_the_first_of_2_1_4_3_0():
    order = [2, 1, 4, 3, 0]
    for one, other in product(order, order):
        assert worst([one, other]) == order[min(order.index(one), order.index(other))]
