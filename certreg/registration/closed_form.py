"""The two classical closed forms of the optimal rotation, in floating point.

Independent of each other and of the exact road: they propose, and are compared with what is proved.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from certreg.geometry import canonical, davenport_matrix, quaternion_from_matrix

if TYPE_CHECKING:
    from numpy.typing import NDArray


def horn(cross_covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """The unit quaternion (4,) of largest eigenvalue of the Davenport matrix of C [Horn1987].

    Where the largest eigenvalue is repeated this is an arbitrary one of the optima.
    """
    davenport = np.array(davenport_matrix(cross_covariance.tolist()))
    return canonical(np.linalg.eigh(davenport)[1][:, -1])


def arun(cross_covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """The same rotation (4,) from the singular value decomposition of C [Arun1987].

    With the determinant rule of [Umeyama1991]: without it a mirrored cloud returns a reflection.
    """
    u, _, vt = np.linalg.svd(cross_covariance)
    sign = np.sign(np.linalg.det(u) * np.linalg.det(vt))
    return quaternion_from_matrix((u * np.array([1.0, 1.0, sign])) @ vt)
