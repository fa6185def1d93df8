"""Claim: which symmetry forces a continuum of equilibria, and which does not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import sympy

from certreg.geometry.so3 import rotation_matrix
from certreg.objective.classification import (
    Classification,
    Pattern,
    classify,
    invariants,
    pattern_of,
)
from certreg.problem.moments import exact_moments
from certreg.problem.problem import RegistrationProblem

from ..algebra import Square, combination, facts, identity, positive
from ..hypothesis import invertible, vanishing
from ..kernel import Claim, Mutation, Proof, Step
from ..moments import MomentCloud
from ..notation import Matrix, matrix, scalar, symmetric

Points = Sequence[Sequence[int]]
CYCLE = ((0, 0, 1), (1, 0, 0), (0, 1, 0))  # a third of a turn about (1, 1, 1)
QUARTER = ((0, -1, 0), (1, 0, 0), (0, 0, 1))  # a quarter of a turn about the third axis
HALF = ((-1, 0, 0), (0, -1, 0), (0, 0, 1))  # half a turn about the third axis
NONE = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
TURN = rotation_matrix((1, 2, 3, 4))  # 30 times a rotation: any other pose of the target


@dataclass(frozen=True, kw_only=True)
class Example:
    """A cloud of integer points, a symmetry of the source, its target, and the pattern.

    symmetry: a rotation that permutes the source. target: a matrix that takes each source point to
    its target; a common factor of it changes nothing. points: the target where it is no such image.
    """

    name: str
    source: Points
    pattern: Pattern
    symmetry: Points = NONE
    target: Points = TURN
    points: Points | None = None
    weights: tuple[int, ...] | None = None

    @property
    def symmetric(self) -> bool:
        """Whether the symmetry permutes the source and keeps the weights."""
        masses = self.weights or (1,) * len(self.source)
        before = {tuple(p): m for p, m in zip(self.source, masses, strict=True)}
        moved = _moved(self.symmetry, self.source)
        after = {tuple(p): m for p, m in zip(moved, masses, strict=True)}
        return before == after

    def classified(self) -> Classification:
        """What the shipped code says, from the points on."""
        targets = _moved(self.target, self.source) if self.points is None else self.points
        problem = RegistrationProblem(list(self.source), list(targets), weights=self.weights)
        return classify(exact_moments(problem))


def _moved(A: Points, points: Points) -> list[tuple[int, ...]]:
    return [tuple(sum(a * x for a, x in zip(row, p, strict=True)) for row in A) for p in points]


MIRROR = tuple(tuple(-a for a in row) for row in TURN)
TRIANGLE = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
SQUARE = ((1, 1, 0), (-1, 1, 0), (-1, -1, 0), (1, -1, 0))
TETRAHEDRON = ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))
CUBE = tuple((a, b, c) for a in (-1, 1) for b in (-1, 1) for c in (-1, 1))
OCTAHEDRON = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
FLAT, TALL = (*TRIANGLE, (0, 0, 0)), (*TRIANGLE, (3, 3, 3))  # pyramids over the triangle
LINE = ((0, 0, 1), (0, 0, 2), (0, 0, 5))
RECTANGLE = ((2, 1, 0), (-2, 1, 0), (-2, -1, 0), (2, -1, 0))
ISOSCELES = ((0, 0, 4), (3, 0, 0), (-3, 0, 0))
CROOKED = ((0, 1, 3), (1, -1, -1), (-3, -2, 0), (-1, 3, -1), (1, 0, -2), (2, -1, 1))

FORCED = (
    Example(name="regular triangle", source=TRIANGLE, symmetry=CYCLE, pattern=(1, 2, 1)),
    Example(name="square", source=SQUARE, symmetry=QUARTER, pattern=(1, 2, 1)),
    Example(name="flat pyramid", source=FLAT, symmetry=CYCLE, pattern=(1, 2, 1)),
    Example(name="tall pyramid", source=TALL, symmetry=CYCLE, pattern=(1, 1, 2)),
    Example(name="regular tetrahedron", source=TETRAHEDRON, symmetry=CYCLE, pattern=(1, 3)),
    Example(name="cube", source=CUBE, symmetry=QUARTER, pattern=(1, 3)),
    Example(name="points on the axis", source=LINE, symmetry=QUARTER, pattern=(2, 2)),
)
HALF_TURNS = (
    Example(name="rectangle", source=RECTANGLE, symmetry=HALF, pattern=(1, 1, 1, 1)),
    Example(name="isosceles triangle", source=ISOSCELES, symmetry=HALF, pattern=(1, 1, 1, 1)),
)
MIRRORED = (
    Example(
        name="regular tetrahedron",
        source=TETRAHEDRON,
        symmetry=CYCLE,
        target=MIRROR,
        pattern=(3, 1),
    ),
    Example(name="tall pyramid", source=TALL, symmetry=CYCLE, target=MIRROR, pattern=(2, 1, 1)),
    Example(name="flat pyramid", source=FLAT, symmetry=CYCLE, target=MIRROR, pattern=(1, 2, 1)),
)
OTHER_TARGETS = (
    Example(
        name="octahedron, opposite vertices with one target",
        source=OCTAHEDRON,
        symmetry=QUARTER,
        points=((1, 0, 0), (1, 0, 0), (0, 2, 0), (0, 2, 0), (0, 0, 3), (0, 0, 3)),
        pattern=(4,),
    ),
    Example(
        name="regular triangle to another one",
        source=TRIANGLE,
        symmetry=CYCLE,
        points=((1, 0, 0), (0, 2, 0), (0, 0, 5)),
        pattern=(1, 1, 1, 1),
    ),
)
UNEQUAL = Example(
    name="square with unequal weights",
    source=SQUARE,
    symmetry=QUARTER,
    weights=(1, 2, 1, 2),
    pattern=(1, 1, 1, 1),
)
WITHOUT = Example(name="six points without symmetry", source=CROOKED, pattern=(1, 3))


C, SINE, SCATTER = scalar("c"), scalar("s"), symmetric("S")
ABOUT_THIRD = Matrix([[C, -SINE, 0], [SINE, C, 0], [0, 0, 1]])
COMMUTATOR = ABOUT_THIRD * SCATTER - SCATTER * ABOUT_THIRD
COMMUTES = vanishing(
    r"The source is symmetric: its scatter commutes with the rotation $Q$.",
    COMMUTATOR,
    solves=tuple(sorted(SCATTER.free_symbols, key=str)),
)
TURNING = invertible(
    r"The angle of $Q$ is neither $0$ nor $180^\circ$: $s \ne 0$.", SINE, scalar("s_inverse")
)


def proof(forced: Sequence[Example] = FORCED, *, commuting: bool = True) -> Proof:
    """Symmetry makes the scatter commute with a rotation; that makes two eigenvalues equal."""
    yield from _double_eigenvalue(commuting=commuting)
    yield from _pattern()
    yield _examples(
        "Examples of the theorem, through the shipped code from the points on: ",
        ": in each the rotation permutes the points, and the spurious equilibria are infinitely "
        "many.",
        forced,
        infinite=True,
    )
    yield from _counterexamples()


def _double_eigenvalue(*, commuting: bool) -> Proof:
    cloud, Q, S = MomentCloud(), matrix("Q"), SCATTER
    moved = cloud.total((Q * cloud.x) * (Q * cloud.x).T)
    yield identity(
        r"Let a rotation $Q$ about the centroid permute the points with their weights. The scatter "
        r"of the turned cloud is $\sum_i m_i\, Q \tilde x_i (Q \tilde x_i)^{\mathsf T} = "
        r"Q S_2 Q^{\mathsf T}$; but it is the same sum in another order. So $Q S_2 Q^{\mathsf T} = "
        r"S_2$: the scatter commutes with $Q$.",
        moved,
        Q * cloud.source_scatter * (Q.T if commuting else Q),
    )
    c, s = scalar("c"), scalar("s")
    E = COMMUTATOR
    far = (c - 1) ** 2 + s**2
    yield identity(
        r"Put the third axis along that of $Q$, a rotation by an angle with cosine $c$ and sine "
        r"$s$, and let $E = Q S - S Q$. Then $\;2 s S_{12} = -E_{11}$, $\;s (S_{11} - S_{22}) = "
        r"E_{12}$, and with $f = (c - 1)^2 + s^2$ $\;f S_{13} = (c - 1) E_{13} + s E_{23}\;$ and "
        r"$\;f S_{23} = (c - 1) E_{23} - s E_{13}$.",
        [2 * s * S[0, 1], s * (S[0, 0] - S[1, 1]), far * S[0, 2], far * S[1, 2]],
        [-E[0, 0], E[0, 1], (c - 1) * E[0, 2] + s * E[1, 2], (c - 1) * E[1, 2] - s * E[0, 2]],
    )
    yield positive(
        r"If the angle is neither $0$ nor $180^\circ$, then $s \neq 0$ and $f > 0$, and from $E = "
        r"0$ it follows that $S = \operatorname{diag}(p, p, r)$: two equal eigenvalues. An axis of "
        r"order at least three has such a rotation.",
        far,
        [[Square(c - 1)], [Square(TURNING[0])]],
    )
    yield _equal_diagonal()
    half = sympy.diag(-1, -1, 1)
    yield identity(
        r"An axis of order two forces nothing of the kind: for the half turn $Q = "
        r"\operatorname{diag}(-1, -1, 1)$ the commutator is zero for every $S$ with $S_{13} = "
        r"S_{23} = 0$, whatever $S_{11}, S_{12}, S_{22}$ are.",
        half * S - S * half,
        2 * Matrix([[0, 0, -S[0, 2]], [0, 0, -S[1, 2]], [S[0, 2], S[1, 2], 0]]),
    )


def _equal_diagonal() -> Step:
    a, b = scalar("a"), scalar("b")
    off, apart = SCATTER[0, 1], SCATTER[0, 0] - SCATTER[1, 1]
    inverse = scalar("s_inverse")
    return combination(
        r"So across the axis the scatter is a multiple of $I$: for all $a$ and $b$ the number $a "
        r"S_{12} + b\,(S_{11} - S_{22})$ is a combination of entries of $E$ and of $s s^{-1} - 1$.",
        a * off + b * apart,
        [
            (-a * inverse / 2, COMMUTES[0, 0]),
            (b * inverse, COMMUTES[0, 1]),
            (-a * off - b * apart, TURNING[0]),
        ],
    )


def _pattern() -> Proof:
    p, r = scalar("p"), scalar("r")
    yield identity(
        r"Let $y = R x + t$ with a rotation $R$. Then $C = R S_2$ has the special singular values "
        r"$p, p, r \geq 0$ in some order, and the discriminant vanishes: there are not four "
        r"equilibria.",
        invariants(sympy.diag(p, p, r).tolist()).discriminant,
        0,
    )
    cases = {
        (2, 1): (1, 2, 1),
        (2, 0): (1, 2, 1),
        (1, 2): (1, 1, 2),
        (1, 1): (1, 3),
        (0, 1): (2, 2),
    }
    kinds = [
        Classification(pattern=pattern, inertia_definite=True, ambiguity=None)
        for pattern in cases.values()
    ]
    yield facts(
        r"All values are nonnegative, so by the claim `classification` the row is 1,2,1 for "
        r"$p > r$, 1,1,2 for $0 < p < r$, 1,3 for $p = r > 0$, and 2,2 for $p = 0 < r$, where the "
        r"points lie on the axis. In each of them the spurious equilibria are infinitely many. "
        r"(For $p = r = 0$ all points coincide.)",
        [pattern_of([[a, 0, 0], [0, a, 0], [0, 0, b]]) for a, b in cases]
        + [kind.spurious for kind in kinds],
        [*cases.values(), *[None] * len(cases)],
    )


def _counterexamples() -> Proof:
    yield _examples(
        r"Symmetric all the same, and with exactly three spurious equilibria: ",
        r". Their axes are of order two.",
        HALF_TURNS,
    )
    yield _examples(
        r"An axis of order three is not enough where the target is a mirror image, $y = -R x$: ",
        r". The spurious equilibria are one, two and infinitely many.",
        MIRRORED,
    )
    yield _examples(
        r"Nor where the target is no image of the source: ",
        r". In the first $C = 0$ and there is no spurious equilibrium, in the second there are "
        r"three.",
        OTHER_TARGETS,
    )
    broken = facts(
        r"Nor where the symmetry does not keep the weights: a square with the weights 1, 2, 1, 2 "
        r"has exactly three spurious equilibria.",
        [UNEQUAL.symmetric, UNEQUAL.classified().pattern],
        [False, UNEQUAL.pattern],
    )
    yield broken
    distances = {sum(x * x for x in point) for point in CROOKED}
    centred = all(sum(point[k] for point in CROOKED) == 0 for k in range(3))
    yield facts(
        r"And infinitely many spurious equilibria need no symmetry: six points about the origin, "
        r"at six different distances from it and not in a plane, so that no isometry but the "
        r"identity permutes them, with a scatter of $16\, I$. Their row is 1,3, like the cube's.",
        [
            centred,
            len(distances),
            Matrix(CROOKED).rank(),
            Matrix(CROOKED).T * Matrix(CROOKED) == 16 * sympy.eye(3),
            WITHOUT.classified().pattern,
        ],
        [True, len(CROOKED), 3, True, WITHOUT.pattern],
    )


def _examples(
    before: str, after: str, examples: Sequence[Example], *, infinite: bool = False
) -> Step:
    named = "; ".join(f"{e.name}: {','.join(map(str, e.pattern))}" for e in examples)
    kinds = [example.classified() for example in examples]
    found: list[Any] = [*(e.symmetric for e in examples), *(kind.pattern for kind in kinds)]
    expected: list[Any] = [*[True] * len(examples), *(e.pattern for e in examples)]
    if infinite:
        found += [kind.spurious for kind in kinds]
        expected += [None] * len(examples)
    return facts(before + named + after, found, expected)


CLAIM = Claim(
    name="symmetry",
    title="Symmetry and infinitely many equilibria",
    statement=r"Let $y_i = R x_i + t$ with a rotation $R$, and let the source with its weights "
    r"have a rotation axis of order at least three and not be a single point. Then there are "
    r"infinitely many spurious equilibria: $S_2$ is $Q S_2 Q^{\mathsf T}$ and has two equal "
    r"eigenvalues. Without these conditions symmetry need not have this "
    r"effect: for axes of order two, mirrored clouds, other targets and weights without the "
    r"symmetry there are exact counterexamples; nor is symmetry necessary for it.",
    concludes=(1, 2, 3, 4, 6, 7, 8, 9, 10, 11, 12, 13),
    hypotheses=(COMMUTES, TURNING),
    setting=(
        (
            r"$y_i = R x_i + t$ with $R \in \mathrm{SO}(3)$: no noise, not mirrored. $Q$ turns by "
            r"an angle with cosine $c$ and sine $s$ and permutes the weighted source."
        ),
    ),
    source="[Yang2020], the conjecture's part (ii)",
    proof=proof,
    controls={
        "a rectangle among the examples": Mutation(
            at=8, proof=lambda: proof(forced=(*FORCED, HALF_TURNS[0]))
        ),
        "a mirrored tetrahedron among the examples": Mutation(
            at=8, proof=lambda: proof(forced=(*FORCED, MIRRORED[0]))
        ),
        "the scatter of the turned cloud as Q S Q": Mutation(
            at=1, proof=lambda: proof(commuting=False)
        ),
    },
    not_claimed=r"Anything about symmetry that holds only approximately: a cloud in floating point "
    r"may miss its symmetry by a rounding and then has exactly four equilibria.",
    needs=("classification", "spectrum"),
    used_by=("certreg.objective.classification.classify",),
    not_in_coq=(
        "Nothing in Coq speaks of symmetry; what follows from a repeated eigenvalue is on "
        "the page `classification`."
    ),
)
