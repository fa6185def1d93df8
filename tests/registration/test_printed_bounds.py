"""What was proved of a number holds of the printed one: tests on both sides of a decimal."""

from __future__ import annotations

import numpy as np
from test_consensus import certified

CLOUD = np.vstack([np.diag([3.0, 2.0, 1.0]), -np.diag([3.0, 2.0, 1.0])])
LONGER = np.vstack([np.diag([4.0, 2.0, 1.0]), -np.diag([4.0, 2.0, 1.0])])  # off by 1, twice


def test_a_bound_on_residuals_is_printed_as_it_was_given():
    """The identity brings all six pairs within 1; that none brings more than 5 is of less."""
    result = certified(CLOUD, LONGER, 0.9999996)

    assert result.upper == 5
    assert "no rigid motion brings more than 5 of the 6 pairs within 0.9999996;" in result.headline
