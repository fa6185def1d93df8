"""All equilibria by elimination: exact, over the rationals, from the six torque quadratics.

In a chart a . q = 1 of quaternion space, coordinates (1, u) = (1, u1, u2, u3), the six quadratics
are six equations in the six products u_i u_j. Where that 6x6 block is invertible, one elimination
rewrites every product as a linear polynomial, and where the three multiplication matrices commute
these rules are a Groebner basis: the quotient ring has the basis 1, u1, u2, u3, there are exactly
four complex solutions with multiplicity, and none at infinity. The critical value
l = q^T K q / |q|^2 is the linear form a . K q on the solutions (contract the minors of [q, K q]
with a), so its multiplication matrix M, on the same basis, has the critical values as eigenvalues,
and its characteristic polynomial is the univariate eliminant.

No chart loses a solution: four lines lie in at most twelve of the thirteen hyperplanes with
a = (1, t, t^2, t^3). If the six quadratics are dependent, the solutions form a continuum. Then the
same contraction, l q = K q, makes l act on all linear forms, the minimal polynomial of that action
is the eliminant, and the fibre over each of its roots is a linear space of quaternions, one
component. That these are all is checked by the Hilbert function in degree two.

Floats never enter; roots are isolated in ball arithmetic and refined as far as is asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, Any

from flint import acb, arb, arb_mat, ctx, fmpq_mat, fmpz_mat, fmpz_poly

from certreg.equilibrium.critical_set import Completeness, CriticalSet, spaces_as_components
from certreg.equilibrium.torques import CHARTS, COLUMNS, Table, torque_table
from certreg.errors import ContradictionError
from certreg.exact.balls import fixed_point, morse_bott_index, orthonormal, radius_bits
from certreg.exact.spaces import Space, resolved
from certreg.results import Guarantee

if TYPE_CHECKING:
    from certreg.objective.isotropic import Isotropic

GROEBNER = "groebner"
GUARD_BITS = 32  # more than products of four matrices lose; more are taken where not
SOLUTIONS = 4  # dimension of the quotient ring: the basis 1, u1, u2, u3
PRODUCTS = 6  # u_i u_j, i <= j


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Elimination:
    """What elimination makes of the quadratics.

    chart: a, of the hyperplane a . q = 1; None where the solutions form a continuum.
    dimension: of the quotient ring, the number of complex solutions; None: infinite.
    rank: of the six quadratics.
    action: 4x4 over Q; l u_j = sum_k action[j, k] u_k on every solution, q = frame u.
    frame: 4x4 integers of determinant 1.
    eliminant: coefficients, lowest first, of the squarefree integer polynomial whose roots are the
        critical values, in units of C.
    fibres: its irreducible factors, each with the dimension of the fibre over each of its roots.
    """

    chart: tuple[int, ...] | None
    dimension: int | None
    rank: int
    action: fmpq_mat
    frame: Table
    eliminant: fmpz_poly
    fibres: tuple[tuple[fmpz_poly, int], ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fibre:
    """One component of the equilibria: a linear space of quaternions, up to sign and length.

    dimension: of the rotations in it. value: its critical value, in units of C.
    vectors: (4,) each, spanning; balls.
    """

    dimension: int
    value: arb
    vectors: tuple[tuple[arb, ...], ...]

    @property
    def degree(self) -> int:
        """The degree of the variety of its rotations in the nine entries of R.

        They are quadratic in the quaternion, so a line becomes a conic, a plane a Veronese surface
        and everything SO(3), of degrees 2, 4 and 8.
        """
        return 1 << self.dimension


def by_elimination(objective: Isotropic) -> CriticalSet:
    """The fibres of the elimination; indices from the Hessian of the energy, in ball arithmetic."""
    cross, shift = objective.moments.cross, objective.shift
    elimination = eliminate(cross, objective.davenport)
    parts: tuple[Fibre, ...] = ()

    def spaces_at(bits: int) -> tuple[Space, ...]:
        nonlocal parts
        parts = fibres(elimination, bits)
        return tuple(
            Space(
                values=(fixed_point(part.value, bits - shift),) * len(part.vectors),
                vectors=tuple(tuple(fixed_point(c, bits) for c in v) for v in part.vectors),
            )
            for part in parts
        )

    resolution = resolved(spaces_at)
    bits = 2 * resolution.bits
    indices = [morse_bott_index(cross, p.vectors[0], p.dimension, bits=bits) for p in parts]
    return CriticalSet(
        method=GROEBNER,
        components=spaces_as_components(
            resolution, objective.energy_of_eigenvalue, indices, Guarantee.EXACT
        ),
        bits=resolution.bits,
        completeness=Completeness.ELIMINATION,
    )


def eliminate(C: Sequence[Sequence[int]], K: Sequence[Sequence[int]]) -> Elimination:
    """The elimination of an integer 3x3 matrix C (any positive factor of it will do), exactly.

    K: Davenport's matrix of C, of which nothing is used but that it gives the critical value.
    """
    table = torque_table(C)
    for t in range(CHARTS):
        frame = _frame(t)
        reduced, unit, rank = fmpz_mat(_in_frame(table, t)).rref()
        if rank < PRODUCTS:
            return _continuum(K, rank)
        if int(reduced[PRODUCTS - 1, PRODUCTS - 1]) == 0:
            continue  # a solution at infinity of this chart
        return _quotient(K, frame, reduced, int(unit), chart=(1, t, t * t, t**3))
    raise ContradictionError(
        "the quadratics are independent, yet every chart has a solution at infinity",
        methods=("groebner",),
    )


def fibres(elimination: Elimination, bits: int) -> tuple[Fibre, ...]:
    """The real components, largest critical value first, quaternions to about so many bits.

    Exactly isolated: balls of different roots are disjoint, those of real roots are real. The
    fibre over a root r is the image of the product of (action - s) over the other roots s.
    """
    precision = bits + GUARD_BITS
    while True:
        with ctx.workprec(precision):
            parts = [
                _fibre(elimination, root.real, d)
                for root, d in _roots(elimination)
                if root.imag == 0
            ]
            if all(
                radius_bits(entry) < -bits for part in parts for v in part.vectors for entry in v
            ):
                return tuple(sorted(parts, key=_value, reverse=True))
        precision *= 2


def _frame(t: int) -> Table:
    """The integer matrix S with q = S u that makes u_0 = (1, t, t^2, t^3) . q."""
    return [[1, -t, -t * t, -(t**3)], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]


def _in_frame(table: Table, t: int) -> Table:
    """The quadratics in u: w = u_0 - t x - t^2 y - t^3 z."""
    if t == 0:
        return table
    column = {pair: k for k, pair in enumerate(COLUMNS)}
    frame = _frame(t)
    change = [[0] * len(COLUMNS) for _ in COLUMNS]
    for (i, j), row in zip(COLUMNS, change, strict=True):
        for a, left in enumerate(frame[i]):
            for b, right in enumerate(frame[j]):
                row[column[min(a, b), max(a, b)]] += left * right
    columns = list(zip(*change, strict=True))
    return [[sum(map(int.__mul__, row, c)) for c in columns] for row in table]


def _quotient(
    K: Sequence[Sequence[int]], frame: Table, reduced: fmpz_mat, unit: int, chart: tuple[int, ...]
) -> Elimination:
    """The quotient ring of a chart, from its rules unit * u_i u_j = a linear polynomial."""
    shifts = _multiplications(reduced, unit)
    if any(a * b != b * a for a, b in combinations(shifts, 2)):
        raise ContradictionError(
            "the rules of a chart are no Groebner basis: the quadratics contradict each other",
            methods=("groebner",),
        )
    image = [sum(a * entry for a, entry in zip(chart, column, strict=True)) for column in K]
    form = [sum(image[i] * frame[i][k] for i in range(4)) for k in range(4)]
    product = fmpz_mat(4, 4, [form[0] * unit * (i == j) for i in range(4) for j in range(4)])
    for coefficient, shift in zip(form[1:], shifts, strict=True):
        product += coefficient * shift
    action = fmpq_mat(product) / unit
    eliminant = action.charpoly().numer()
    return Elimination(
        chart=chart,
        dimension=SOLUTIONS,
        rank=PRODUCTS,
        action=action,
        frame=frame,
        eliminant=eliminant,
        fibres=((eliminant, 0),),
    )


def _multiplications(reduced: fmpz_mat, unit: int) -> list[fmpz_mat]:
    """Matrices of multiplication by u1, u2, u3, times `unit`: u_k u_j = sum_i X_k[j, i] u_i."""
    rules: dict[tuple[int, int], list[int]] = {}
    for row, pair in enumerate(COLUMNS[:PRODUCTS]):
        *linear, constant = (-int(reduced[row, k]) for k in range(PRODUCTS, len(COLUMNS)))
        rules[pair] = [constant, *linear]
    return [
        fmpz_mat(
            [
                [unit * (i == k) for i in range(4)],
                *(rules[min(j, k), max(j, k)] for j in range(1, 4)),
            ]
        )
        for k in range(1, 4)
    ]


def _continuum(K: Sequence[Sequence[int]], rank: int) -> Elimination:
    """The positive-dimensional case: l acts on all linear forms as K does."""
    action = fmpz_mat([list(row) for row in K])
    eliminant = action.minpoly()
    factors = tuple((f, _nullity(f, action) - 1) for f, _ in eliminant.factor()[1])
    sections = sum(f.degree() * (d + 1) * (d + 2) // 2 for f, d in factors)
    if sections != len(COLUMNS) - rank:
        raise ContradictionError(
            "the components found have another Hilbert function than the quadratics",
            methods=("groebner",),
        )
    return Elimination(
        chart=None,
        dimension=None,
        rank=rank,
        action=fmpq_mat(action),
        frame=_frame(0),
        eliminant=eliminant,
        fibres=factors,
    )


def _nullity(factor: fmpz_poly, action: fmpz_mat) -> int:
    """The dimension of the kernel of action - r, for each root r of an irreducible factor."""
    image = fmpz_mat(4, 4)
    one = fmpz_mat(4, 4, [int(i == j) for i in range(4) for j in range(4)])
    for coefficient in reversed(factor.coeffs()):
        image = image * action + coefficient * one
    return (4 - image.rank()) // factor.degree()


def _roots(elimination: Elimination) -> list[tuple[acb, int]]:
    """Each complex root of the eliminant, isolated, with the dimension of its fibre."""
    roots: list[tuple[acb, int]] = []
    for factor, dimension in elimination.fibres:
        pairs: Any = factor.complex_roots()  # the stubs of python-flint know no pairs
        if any(multiplicity > 1 for _, multiplicity in pairs):
            raise ContradictionError(
                "a critical value of the finite case is repeated", methods=("groebner",)
            )
        roots += [(root, dimension) for root, _ in pairs]
    return roots


def _fibre(elimination: Elimination, value: arb, dimension: int) -> Fibre:
    """The fibre over a real root r: the image of (eliminant / (x - r))(action), in q."""
    *rest, leading = elimination.eliminant.coeffs()
    action, one = arb_mat(elimination.action), arb_mat(4, 4, 1)
    image, quotient = arb_mat(4, 4, arb(leading)), arb(leading)
    for coefficient in reversed(rest[1:]):
        quotient = quotient * value + coefficient
        image = image * action + quotient * one
    spanning = arb_mat(elimination.frame) * image
    return Fibre(
        dimension=dimension,
        value=value,
        vectors=orthonormal(spanning.transpose().table(), dimension + 1),
    )


def _value(part: Fibre) -> arb:
    return part.value.mid()
