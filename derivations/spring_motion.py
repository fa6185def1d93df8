r"""The body on springs that are matrices: sums over points, Lagrangian, equations of motion.

Spring i pulls with 2 W_i (y_i - R x_i - c), W_i positive semidefinite; its point has the mass
m_i = tr W_i / 3 and the damping mu m_i, which is the paper's body where W_i = m_i I. x and y are
taken about the means of source and target with these masses, c is the difference of those means.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from itertools import product
from typing import Any

import sympy

from .moments import inertia_of
from .motion import DAMPING, State, body_kinetic_energy, left_gradient, position, velocity
from .notation import (
    Array,
    Matrix,
    entry,
    gradient,
    hat,
    inner,
    matrix,
    scalar,
    square,
    symmetric,
    vector,
)

UPPER = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))  # of a symmetric matrix, as they are kept
FULL = tuple(UPPER.index((min(a, b), max(a, b))) for a, b in product(range(3), repeat=2))
DIAGONAL = (0, 3, 5)  # among the six
AXES = tuple(hat(axis) for axis in sympy.eye(3).columnspace())


def six(A: Any) -> list[Any]:
    """The entries 11 12 13 22 23 33 of a symmetric matrix."""
    return [A[a, b] for a, b in UPPER]


def table(name: str, columns: int) -> Array:
    """A matrix of symbols with a row for each of the six entries of W."""
    return Matrix(6, columns, lambda i, j: entry(name, i + 1, j + 1))


def _lever_about_mean() -> Array:
    """The sums of W_ab x, of which those of tr W x vanish: the last row follows."""
    lever = table("A", 3)
    for j in range(3):
        lever[5, j] = -lever[0, j] - lever[3, j]
    return lever


@dataclass(frozen=True)
class SpringCloud:
    """Correspondences with matrices for springs, of any number, through their sums.

    One of them is W (symmetric), x, p = W y and s = y^T W y. stiffness: sum W. lever: sum W_ab x,
    a row for each of the six entries. scatter: sum W_ab x x^T, a row of six for each. target: sum
    W y; cross: sum W y x^T; spread: sum y^T W y. sum tr(W) x = 0.
    """

    W: Array = field(default_factory=lambda: symmetric("W"))
    x: Array = field(default_factory=lambda: vector("x"))
    p: Array = field(default_factory=lambda: vector("p"))
    s: Any = field(default_factory=lambda: scalar("s"))
    stiffness: Array = field(default_factory=lambda: symmetric("S"))
    lever: Array = field(default_factory=_lever_about_mean)
    scatter: Array = field(default_factory=lambda: table("B", 6))
    target: Array = field(default_factory=lambda: vector("b"))
    cross: Array = field(default_factory=lambda: matrix("C"))
    spread: Any = field(default_factory=lambda: scalar("spread"))

    @cached_property
    def mass(self) -> Any:
        """M, the sum of m = tr W / 3."""
        return self.stiffness.trace() / 3

    @cached_property
    def source_scatter(self) -> Array:
        """The sum of m x x^T."""
        upper = [sum(self.scatter[row, k] for row in DIAGONAL) / 3 for k in range(6)]
        return Matrix(3, 3, [upper[k] for k in FULL])

    @cached_property
    def inertia(self) -> Array:
        """J, the sum of m (|x|^2 I - x x^T)."""
        return inertia_of(self.source_scatter)

    @property
    def point_mass(self) -> Any:
        """The mass m = tr W / 3 of one point."""
        return self.W.trace() / 3

    def total(self, of_a_point: Any) -> Any:
        """The sum over the points of a polynomial, linear in W, p, s, and of those degrees in x.

        Raises ValueError for one that no sum is kept of.
        """
        if isinstance(of_a_point, sympy.MatrixBase):
            return of_a_point.applyfunc(self.total)
        terms = _terms(sympy.sympify(of_a_point), (*six(self.W), *self.p, self.s, *self.x))
        return sum((c * self._sum(powers) for powers, c in terms), start=sympy.Integer(0))

    def _sum(self, powers: tuple[int, ...]) -> Any:
        spring = [k for k, power in enumerate(powers[:10]) for _ in range(power)]
        at = [j for j, power in enumerate(powers[10:]) for _ in range(power)]
        match spring, at:
            case [k], [] if k < 6:
                return six(self.stiffness)[k]
            case [k], [j] if k < 6:
                return self.lever[k, j]
            case [k], [i, j] if k < 6:
                return self.scatter[k, UPPER.index((i, j))]
            case [k], [] if k < 9:
                return self.target[k - 6]
            case [k], [j] if k < 9:
                return self.cross[k - 6, j]
            case [9], []:
                return self.spread
            case _:
                raise ValueError(f"no sum of degrees {powers} is kept")


@lru_cache(maxsize=4096)  # proofs and their controls take the same sums
def _terms(of_a_point: Any, point: tuple[Any, ...]) -> tuple[Any, ...]:
    """The powers of the numbers of a point and their coefficients."""
    return tuple(sympy.Poly(of_a_point, *point).terms())


def potential_energy(state: State, cloud: SpringCloud) -> Any:
    """V_p, the sum of (y - r)^T W (y - r) = s - 2 p.r + r^T W r, r the place of a point."""
    r = position(state, cloud.x)
    return cloud.total(cloud.s - 2 * inner(cloud.p, r) + (r.T * cloud.W * r)[0])


def kinetic_energy(state: State, cloud: SpringCloud) -> Any:
    """V_k as the sum of m |velocity|^2 / 2, for any matrix R."""
    return cloud.total(cloud.point_mass * square(velocity(state, cloud.x))) / 2


def newton_euler(state: State, cloud: SpringCloud) -> tuple[Array, Array]:
    """M a and J alpha, added up over the points: springs, drag, and less omega x J omega."""
    r, m = position(state, cloud.x), cloud.point_mass
    pull = 2 * (cloud.p - cloud.W * r)
    drag = DAMPING * m * velocity(state, cloud.x)
    turning = DAMPING * m * cloud.x.cross(state.omega.cross(cloud.x))
    force = cloud.total(pull - drag)
    torque = cloud.total(cloud.x.cross(state.R.T * pull) - turning)
    return force, torque - state.omega.cross(cloud.inertia * state.omega)


def euler_poincare(state: State, cloud: SpringCloud) -> tuple[Array, Array]:
    """M a and J alpha from the Lagrangian L = V_k - V_p with Rayleigh's dissipation mu V_k."""
    kinetic = body_kinetic_energy(state, cloud)  # type: ignore[arg-type] - mass and inertia
    potential = potential_energy(state, cloud)
    momentum = gradient(kinetic, state.omega)
    force = -gradient(potential, state.c) - DAMPING * gradient(kinetic, state.v)
    torque = -left_gradient(potential, state.R) - DAMPING * momentum
    return force, torque + momentum.cross(state.omega)


@dataclass(frozen=True)
class SpringBody:
    """The constants of the dynamics per unit of mass, the parameters of the generated code.

    stiffness S, lever A, target b and cross C as in `SpringCloud`, over M; scatter: of the sums of
    W_ab x x^T what has no trace, neither in W nor in x x^T; spread: with what these traces add to
    the energy. inertia J / M and its inverse.
    """

    stiffness: Array = field(default_factory=lambda: symmetric("S"))
    lever: Array = field(default_factory=lambda: table("A", 3))
    scatter: Array = field(default_factory=lambda: table("B", 6))
    target: Array = field(default_factory=lambda: vector("b"))
    cross: Array = field(default_factory=lambda: matrix("C"))
    spread: Any = field(default_factory=lambda: scalar("spread"))
    inertia: Array = field(default_factory=lambda: symmetric("J"))
    inertia_inverse: Array = field(default_factory=lambda: symmetric("I"))

    @property
    def parts(self) -> dict[str, Any]:
        """What is kept of a body, in order: of symmetric matrices the upper triangles."""
        return {
            "stiffness": six(self.stiffness),
            "lever": self.lever,
            "scatter": self.scatter,
            "target": self.target,
            "cross": self.cross,
            "spread": self.spread,
            "inertia": six(self.inertia),
            "inertia_inverse": six(self.inertia_inverse),
            "damping": DAMPING,
        }


def shift(c: Array, body: SpringBody) -> Array:
    """What c adds to the pull on the rotation: the 3x3 entries (a, j), the sum of A_ab,j c_b."""
    rows = body.lever
    return Matrix(3, 3, lambda a, j: sum(rows[FULL[3 * a + b], j] * c[b] for b in range(3)))


def turned(R: Array, body: SpringBody) -> Array:
    """The entries (a, j), the sum over b and k of B_ab,jk R_bk."""
    rows = body.scatter

    def part(a: int, j: int) -> Any:
        each = product(range(3), repeat=2)
        return sum(rows[FULL[3 * a + b], FULL[3 * j + k]] * R[b, k] for b, k in each)

    return Matrix(3, 3, part)


def swung(R: Array, body: SpringBody) -> Array:
    """What R adds to the force: the entries a, the sum over b and j of A_ab,j R_bj."""
    rows = body.lever
    each = list(product(range(3), repeat=2))
    return Matrix([sum(rows[FULL[3 * a + b], j] * R[b, j] for b, j in each) for a in range(3)])


def spring_force(c: Array, R: Array, body: SpringBody) -> Array:
    """The force of the springs over M: 2 (b - A R - S c)."""
    return 2 * (body.target - swung(R, body) - body.stiffness * c)


def pull(c: Array, R: Array, body: SpringBody) -> Array:
    """The matrix P = C - A c - B R: -2 P is the derivative of V_p / M with respect to R."""
    return body.cross - shift(c, body) - turned(R, body)


def torque_of(pulled: Array, R: Array) -> Array:
    """The torque of the springs over M, 2 <P, R [e_k]> along each axis of the body."""
    return Matrix([2 * inner(pulled, R * axis) for axis in AXES])


def potential(state: State, body: SpringBody) -> Any:
    """V_p / M where R is a rotation: spread - b.c - <C, R> - c.f / 2 - <P, R>."""
    force = spring_force(state.c, state.R, body)
    pulled = pull(state.c, state.R, body)
    linear = inner(body.target, state.c) + inner(body.cross, state.R)
    return body.spread - linear - inner(state.c, force) / 2 - inner(pulled, state.R)


def rate(state: State, body: SpringBody) -> Array:
    """The rates s' = F(s), 18 numbers in the order of the state, for a rotation R."""
    force = spring_force(state.c, state.R, body) - DAMPING * state.v
    torque = torque_of(pull(state.c, state.R, body), state.R)
    turning = torque - state.omega.cross(body.inertia * state.omega)
    alpha = body.inertia_inverse * turning - DAMPING * state.omega
    return Matrix([*state.v, *(state.R * hat(state.omega)), *force, *alpha])


def hessian(state: State, body: SpringBody) -> Array:
    """The Hessian (6, 6) of V_p / M along c + d and R exp([phi]x), in (d, phi)."""
    pulled = pull(state.c, state.R, body)
    turns = [state.R * axis for axis in AXES]
    coupled = 2 * Matrix.hstack(*[swung(turn, body) for turn in turns])

    def bent(k: int, l: int) -> Any:
        both = AXES[k] * AXES[l] + AXES[l] * AXES[k]
        return 2 * inner(turns[k], turned(turns[l], body)) - inner(pulled, state.R * both)

    return Matrix(
        [[2 * body.stiffness, coupled], [coupled.T, Matrix(3, 3, bent)]],
    )


def linearised(state: State, body: SpringBody) -> Array:
    """The linearised dynamics (12, 12) in delta c, phi, delta v, delta omega with dR = R [phi]x."""
    zero, one = sympy.zeros(3, 3), sympy.eye(3)
    pulled = pull(state.c, state.R, body)
    turns = [state.R * axis for axis in AXES]
    coupled = -2 * Matrix.hstack(*[swung(turn, body) for turn in turns])

    def twisted(k: int, l: int) -> Any:
        bent = inner(pulled, state.R * AXES[l] * AXES[k]) - inner(turns[k], turned(turns[l], body))
        return 2 * bent

    gyroscopic = hat(body.inertia * state.omega) - hat(state.omega) * body.inertia
    inverse = body.inertia_inverse
    return Matrix(
        [
            [zero, zero, one, zero],
            [zero, -hat(state.omega), zero, one],
            [-2 * body.stiffness, coupled, -DAMPING * one, zero],
            [
                inverse * coupled.T,
                inverse * Matrix(3, 3, twisted),
                zero,
                inverse * gyroscopic - DAMPING * one,
            ],
        ]
    )
