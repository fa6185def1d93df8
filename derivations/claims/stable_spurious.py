"""Claim: where springs are planes a spurious equilibrium can be stable; 18 planes in integers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from itertools import combinations
from typing import Any

import numpy as np
import sympy

from certreg.geometry.so3 import body_frame, dot
from certreg.objective.quartics import MONOMIALS
from certreg.objective.springs import Springs
from certreg.problem.problem import RegistrationProblem

from ..algebra import Square, facts, identity, nonnegative, positive
from ..hypothesis import Standing, invertible, nonnegative_by
from ..kernel import Claim, Mutation, Proof
from ..notation import Matrix, quaternion, rotation, square

Hessian = Callable[..., Any]
Planes = tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]  # points and normals
FAR = 3  # how far out the points stand that hold the coordinate planes
HALF_TURNS = ((0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1))
Q = quaternion()
w, x, y, z = Q
NORM = square(Q)
OFF = w**2 + x**2 + y**2  # |q|^2 sin^2(theta/2) about the half turn (0, 0, 0, 1)
NEAR = nonnegative_by(
    r"$\theta \le 90^\circ$: $w^2 + x^2 + y^2 \le z^2$.",
    z**2 - OFF,
    standing=Standing.CASE,
    example={w: 1},
)
TURNED = invertible("The rotation is not the identity: $x \\ne 0$, say.", x, standing=Standing.CASE)


def unit(k: int, size: int = 1) -> tuple[int, ...]:
    """A multiple of a coordinate vector."""
    return tuple(size * int(i == k) for i in range(3))


def planes_of(far: int = FAR) -> Planes:
    """Points +-e_j on the planes across e_j, points +-far e_j on those across the other two."""
    walls = [(unit(j, s), unit(j)) for j in range(3) for s in (1, -1)]
    held = [
        (unit(j, s * far), unit(i)) for j in range(3) for i in range(3) if i != j for s in (1, -1)
    ]
    return (*walls, *held)


PLANES = planes_of()


def objective_of(planes: Planes) -> Springs:
    """The shipped objective of these planes; each point is its own target."""
    points = np.array([point for point, _ in planes], float)
    normals = np.array([normal for _, normal in planes], float)
    return Springs.of(RegistrationProblem(points, points, normals=normals))


def energy_of(q: Any) -> Any:
    """The energy times |q|^4: 64 (|q|^4 - sum q_i^4) + 16 |q|^2 (x^2 + y^2 + z^2)."""
    fourth = sum(e**4 for e in q)
    return 64 * (square(q) ** 2 - fourth) + 16 * square(q) * square(q[1:])


def proof(
    curvature: Hessian = Springs.hessian, planes: Planes = PLANES, *, rise: int = 96
) -> Proof:
    """The energy, its only zero, three stable equilibria, and the barrier about one of them."""
    yield from _energy(planes)
    yield _only_optimum()
    yield _three_stable(curvature, planes)
    yield from _barrier(rise)


def _energy(planes: Planes) -> Proof:
    found, force = sympy.Integer(0), sympy.zeros(3, 1)
    for point, normal in planes:
        missed = dot(normal, tuple(NORM * Matrix(point) - rotation(Q) * Matrix(point)))
        found, force = found + missed**2, force + missed * Matrix(normal)
    yield identity(
        r"Eighteen pairs, each point its own target: $\pm e_j$ on the plane with normal $e_j$, "
        r"$\pm 3 e_j$ on the two planes with the other normals. At $t = 0$, with $\hat R = "
        r"|q|^2 R(q)$, the sum of the squares $(n \cdot (|q|^2 x - \hat R x))^2$ is $64\,(|q|^4 - "
        r"\sum_i q_i^4) + 16\,|q|^2 (x^2 + y^2 + z^2)$; and the forces add up to zero, so that "
        r"$t = 0$ is best at every rotation (claim `spring_translation`).",
        [found, *force],
        [energy_of(Q), 0, 0, 0],
    )
    objective = objective_of(planes)
    polynomial = sympy.Poly(energy_of(Q), *Q)
    expected = [_coefficient(polynomial, at) for at in MONOMIALS]
    yield facts(
        r"`certreg.objective.springs.Springs` has the same 35 coefficients, made from the points "
        r"and the normals, and knows of no free translation.",
        [*(objective.unit * c for c in objective.quartic), len(objective.free_translations)],
        [*expected, 0],
    )


def _coefficient(polynomial: Any, monomial: Sequence[int]) -> Fraction:
    powers = tuple(monomial.count(k) for k in range(4))
    return Fraction(int(polynomial.coeff_monomial(sympy.prod(map(pow, Q, powers)))))


def _only_optimum() -> Any:
    pairs = [[128, Square(a * b)] for a, b in combinations(Q, 2)]
    rest = [[16, Square(a * b)] for a in Q for b in (x, y, z) if a is not x or b is not x]
    return positive(
        r"The energy is zero at $R = I$ and positive at every other rotation: the optimum is "
        r"unique, and exact.",
        energy_of(Q),
        [[16, Square(TURNED[0]), Square(TURNED[0])], *pairs, *rest],
    )


def _three_stable(curvature: Hessian, planes: Planes) -> Any:
    objective = objective_of(planes)
    found: list[Any] = []
    for q in HALF_TURNS:
        level, gradient = 4 * objective.value(q), objective.gradient(q)
        along = [level * entry for entry in q]
        frame = Matrix(body_frame(q))
        H = frame.T * Matrix(curvature(objective, q)) * frame - 4 * objective.value(q) * sympy.eye(
            3
        )
        minors = [H[:k, :k].det() > 0 for k in (1, 2, 3)]
        found += [objective.energy(q), list(gradient) == along, all(minors)]
    return facts(
        r"At the half turn about each coordinate axis the energy is $16$, the gradient of $F$ is "
        r"$4F q$, so that it is an equilibrium, and the Hessian in the angles of rotation is "
        r"positive definite by its minors: a strict minimum, all of it computed by "
        r"`certreg.objective.springs.Springs` in integers.",
        found,
        [Fraction(16), True, True] * 3,
    )


def _barrier(rise: int) -> Proof:
    above = energy_of(Q) - 16 * NORM**2
    lifted = [[112, Square(w * a)] for a in (x, y)] + [[32, Square(z * a)] for a in (x, y)]
    yield nonnegative(
        r"About $(0, 0, 0, 1)$, with $\sin^2(\theta/2) = (w^2 + x^2 + y^2)/|q|^2$: within "
        r"$90^\circ$ the energy is at least $16 + 96 \sin^2(\theta/2) \cos^2(\theta/2) = 16 + 24 "
        r"\sin^2\theta$, here times $|q|^4$.",
        above - rise * OFF * z**2,
        [
            *lifted,
            [128, Square(x * y)],
            [16, Square(w), NEAR[0]],
            *([16, Square(w * a)] for a in (x, y)),
        ],
    )
    most = 128 * OFF * NORM - above
    yield nonnegative(
        r"And at most $16 + 128 \sin^2(\theta/2)$, everywhere. So a body released at rest with "
        r"$\sin^2(\theta/2) < 3/16$, within $51^\circ$ of the half turn, and with the translation "
        r"that is best there, has less energy than $16 + 24$; it cannot pass $90^\circ$, where "
        r"there is more. It never comes within $90^\circ$ of the optimum. The same for the other "
        r"axes, as the energy does not change with the order of $x, y, z$.",
        most,
        [
            [16, Square(w * z)],
            [144, Square(w**2)],
            *([128, Square(a**2)] for a in (x, y)),
            *([144, Square(w * a)] for a in (x, y)),
            [128, Square(x * y)],
        ],
    )


def _flipped(objective: Springs, q: Sequence[int]) -> Any:
    return -Matrix(Springs.hessian(objective, q))


CLAIM = Claim(
    name="stable_spurious",
    title="A spurious equilibrium that is stable",
    statement=r"Let $\pm e_j$ lie on the plane with normal $e_j$, and $\pm 3 e_j$ on the two "
    r"planes through the origin with the other normals, $j = 1, 2, 3$: 18 pairs of point and "
    r"plane, each point its own target. Then $f = 0$ at $R = I$ and nowhere else. The half turns "
    r"about the three axes are equilibria with $f = 16$ and a positive definite Hessian. Within "
    r"$90^\circ$ of them $f \ge 16 + 24 \sin^2\theta$, and $f \le 16 + 128 \sin^2(\theta/2)$.",
    concludes=(1, 2, 3, 4, 5, 6),
    hypotheses=(TURNED, NEAR),
    setting=(
        r"$f(R)$ is the least sum over $t$ of the squares of $n \cdot (y - R x - t)$.",
        r"$\theta$ is the angle from the half turn.",
    ),
    source="ours; to the conjecture's part (iii) of [Yang2020], carried over to general springs",
    proof=proof,
    controls={
        "points at 1 that hold all planes": Mutation(
            at=1, proof=lambda: proof(planes=planes_of(far=1))
        ),
        "the half turns are maxima": Mutation(at=4, proof=lambda: proof(_flipped)),
        "a rise of 28 sin^2(theta)": Mutation(at=5, proof=lambda: proof(rise=112)),
    },
    not_claimed="Anything of one weight for each pair, where every spurious equilibrium is "
    "unstable: claim `instability`. That these are all equilibria of the 18 planes.",
    needs=("quaternions", "spring_translation", "quartic_relaxation"),
    runs=("certreg.objective.objective.Objective.hessian",),
    used_by=("derivations.spring_counterexamples",),
    not_in_coq="All of it: the theorems in Coq are about one weight for each pair.",
)
