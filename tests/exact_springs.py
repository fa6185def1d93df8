"""Springs of exact numbers whose energies are known forms of the quaternion.

Choi and Lam: nonnegative, and no sum of squares.

64 (w^4 + x^2 y^2 + y^2 z^2 + z^2 x^2 - 4 wxyz) + 15 is, at unit quaternions, twice the sum of

    6 R12^2 + 6 R23^2 + 4 R31^2 + 2 R22^2  and  (n^T R n + 1/2)^2, n = e_i +- e_j, i < j:

planes, each with its mirror image, so that the best translation is 0. All numbers are exact. The
seven optima are (1, +-1, +-1, +-1) with an even number of minus signs, e_2, e_3, e_4; at the last
three the Hessian is 0.

Two optima: 64 (1 - w^4 - x^4) + 1 is twice the sum of

    8 (R11 - 3/4)^2 + 16 R12^2 + 16 R13^2 + 4 R23^2 + 4 R32^2 + 2 R21^2 + 2 R31^2
    and  (n^T R x)^2, {n, x} = {e_2 + e_3, e_2 - e_3}.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from certreg.problem.problem import RegistrationProblem

E1, E2, E3 = np.eye(3)
LEAST, RANGE = 15.0, 64.0  # of the energy
RANDOM_PLANES = 30

Plane = tuple[float, np.ndarray, np.ndarray, float]  # l, n, x, s: the energy l^2 (n^T R x - s)^2


def choi_lam() -> RegistrationProblem:
    """The exact one."""
    return _problem(_choi_lam_planes())


def two_optima() -> RegistrationProblem:
    """The identity and the half turn about x, and no other."""
    plus, minus = E2 + E3, E2 - E3
    found: list[Plane] = [
        *[(2.0, E1, E1, 0.75)] * 2,
        *[(4.0, E1, x, 0.0) for x in (E2, E3)],
        *[(2.0, *pair, 0.0) for pair in ((E2, E3), (E3, E2))],
        *[(1.0, n, E1, 0.0) for n in (E2, E3) for _ in range(2)],
        *[(1.0, *pair, 0.0) for pair in ((plus, minus), (minus, plus))],
    ]
    return _problem(found)


def perturbed(seed: int, share: float = 0.01) -> RegistrationProblem:
    """The same with random planes, whose own energy has about this share of the range."""
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(RANDOM_PLANES, 6))
    rows /= np.linalg.norm(rows.reshape(-1, 2, 3), axis=2).repeat(3, axis=1)
    size = np.sqrt(share * RANGE / RANDOM_PLANES * 3.0)  # their mean is a third each
    added = [(size, row[:3], row[3:], s) for row, s in zip(rows, rng.normal(size=30), strict=True)]
    return _problem([*_choi_lam_planes(), *added])


def _choi_lam_planes() -> list[Plane]:
    six = (2.0, 1.0, 1.0)  # whose squares add up to it
    found = [
        *[(factor, E1, E2, 0.0) for factor in six],
        *[(factor, E2, E3, 0.0) for factor in six],
        (2.0, E3, E1, 0.0),
        *[(1.0, E2, E2, 0.0)] * 2,
    ]
    diagonals = [a + s * b for a, b in combinations((E1, E2, E3), 2) for s in (1, -1)]
    return [*found, *[(1.0, n, n, -0.5) for n in diagonals]]


def _problem(planes: list[Plane]) -> RegistrationProblem:
    both = [(sign, *plane) for plane in planes for sign in (1.0, -1.0)]
    columns = np.array([factor * n for _, factor, n, _, _ in both])
    factors = np.zeros((len(both), 6))
    factors[:, [0, 1, 3]] = columns
    return RegistrationProblem(
        np.array([sign * x for sign, _, _, x, _ in both]),
        np.array([sign * s * n / (n @ n) for sign, _, n, _, s in both]),
        factors=factors,
    )
