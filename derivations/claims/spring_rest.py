"""Claim: on general springs, too, every motion comes to rest; what confines it is S > 0."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ..algebra import Square, combination, contraction, identity, nonnegative, positive, quoted
from ..hypotheses import DAMPED, MASSIVE, PRINCIPAL
from ..hypothesis import Standing, nonnegative_by, nonzero, positive_by, vanishing
from ..kernel import Claim, Mutation, Proof
from ..moments import inertia_of
from ..notation import (
    Array,
    Matrix,
    diagonal,
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

Pull = Callable[[Any, Any], Array]
L = Matrix(3, 3, lambda i, j: entry("l", i + 1, j + 1) if j <= i else 0)
R, X, Y = matrix("R"), vector("x"), vector("y")
CENTRE, V, OMEGA, N = vector("c"), vector("v"), vector("omega"), vector("n")
FORCE, TORQUE, J, M, MU = vector("f"), vector("tau"), symmetric("J"), scalar("M"), scalar("mu")
STRETCHED = Y - R * X - CENTRE
STIFF = nonnegative_by(
    r"$s_1, s_2, s_3 \ge 0$: the eigenvalues of $S$.",
    list(vector("s")),
    example={entry("s", 1): -1, entry("u", 1): 1},
)
RESISTING = positive_by(
    r"$S \succ 0$: $s_1, s_2, s_3 > 0$.", list(vector("s")), standing=Standing.CASE
)
FREE = vanishing(
    r"$L^{\mathsf T} n = 0$, for the $L$ of every spring: $S n = 0$.",
    L.T * N,
    standing=Standing.CASE,
    example={L[0, 0]: 1, N[0]: 1, scalar("a"): 1, Y[0]: 1},
)
TURNING = nonzero(r"The body turns, $\omega \ne 0$.", OMEGA, standing=Standing.CASE)
MOVING = nonzero(r"The body moves, $v \ne 0$.", V, standing=Standing.CASE)


def pull_of(stretched: Any, factor: Any) -> Array:
    """2 W e, W = L L^T."""
    return 2 * factor * factor.T * stretched


def energy_of(place: Any) -> Any:
    """|L^T (y - R x - c)|^2."""
    return square(L.T * (Y - R * X - place))


def proof(pull: Pull = pull_of, *, drag: int = 1, least: int = 1) -> Proof:
    """Compactness, the energy's rate, what is lost, and what happens along free shifts."""
    yield from _confined(least)
    yield from _falls(pull, drag)
    yield from _coasting(pull, drag)
    yield quoted(
        r"LaSalle's invariance principle, as in claim `convergence`, on the state without the "
        r"components of $c$ along free shifts: forces and torques do not depend on these (step 3). "
        r"Of the other components the energy is at least a positive multiple of the square (step "
        r"1, on the orthogonal complement), $R$ is in a compact set, and the energy bounds the "
        r"velocities. So every motion exists for all time and tends to the largest invariant set "
        r"with $v = \omega = 0$, on which force and torque vanish: the equilibria. Where $S n = "
        r"0$, $n \cdot v$ decays like $e^{-\mu t}$ and $n \cdot c$ tends to $n \cdot (c + v/\mu)$ "
        r"of the start.",
        theorem="LaSalle's principle",
        source="[LaSalle1960]",
    )


def _confined(least: int) -> Proof:
    S, s, u = diagonal("s"), vector("s"), vector("u")
    trace, determinant = sum(s), s[0] * s[1] * s[2]
    parts = STIFF.parts
    others = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 1), (0, 2), (0, 2), (1, 2), (1, 2))
    terms = [
        [parts[k], parts[i], parts[j], Square(u[k])]
        for k in range(3)
        for i, j in _without_one(others, k)
    ]
    yield nonnegative(
        r"In the axes of $S$, with $u = c - c^*$ off the best place: the energy at $c$ is that at "
        r"$c^*$ and $u^{\mathsf T} S u$ (claim `spring_translation`), and $(\operatorname{tr} "
        r"S)^2\, u^{\mathsf T} S u \ge \det S\, |u|^2$.",
        trace**2 * (u.T * S * u)[0] - least * determinant * square(u),
        terms,
    )
    one, two, three = RESISTING.parts
    yield positive(
        r"If $S \succ 0$, $\det S > 0$. Then $|u|^2$ is bounded where the energy is, $R$ is in the "
        r"compact set of rotations, on which $c^*$ is continuous, and $J \succ 0$ bounds $\omega$: "
        r"every set $\{V \le E\}$ is compact.",
        determinant,
        [[one, two, three]],
    )
    a = scalar("a")
    yield combination(
        r"If $S n = 0$, $n \ne 0$, the energy is the same at $c$ and at $c + a n$ for all $a$: "
        r"these sets are not bounded.",
        energy_of(CENTRE + a * N) - energy_of(CENTRE),
        contraction(-2 * a * L.T * STRETCHED + a**2 * L.T * N, FREE),
    )


def _without_one(pairs: Sequence[tuple[int, int]], k: int) -> list[tuple[int, int]]:
    """Without one of the pairs of the two indices that are not k: det S is one product of them."""
    left = list(pairs)
    left.remove(next(pair for pair in pairs if k not in pair and pair[0] != pair[1]))
    return left


def _falls(pull: Pull, drag: int) -> Proof:
    pulled = pull(STRETCHED, L)
    yield identity(
        r"One spring, $e = y - R x - c$, pulls with $F = 2 W e$ and the torque $\tau = x \times "
        r"R^{\mathsf T} F$ in the body. As $\dot c = v$ and $\dot R = R[\omega]_\times$, its "
        r"energy changes at the rate $-v \cdot F - \omega \cdot \tau$. Sums of such are the same.",
        inner(gradient(energy_of(CENTRE), CENTRE), V)
        + inner(gradient(energy_of(CENTRE), R), R * hat(OMEGA)),
        -inner(V, pulled) - inner(OMEGA, X.cross(R.T * pulled)),
    )
    a = FORCE - drag * MU * M * V
    alpha = TORQUE - drag * MU * J * OMEGA - OMEGA.cross(J * OMEGA)
    yield identity(
        r"With $M \dot v = F - \mu M v$ and $J \dot\omega = \tau - \mu J \omega - \omega \times J "
        r"\omega$ the kinetic energy changes at the rate $v \cdot F + \omega \cdot \tau - \mu (M "
        r"|v|^2 + \omega^{\mathsf T} J \omega)$. So $\dot V = -\mu (M |v|^2 + \omega^{\mathsf T} J "
        r"\omega)$.",
        inner(V, a) + inner(OMEGA, alpha),
        inner(V, FORCE) + inner(OMEGA, TORQUE) - MU * (M * square(V) + (OMEGA.T * J * OMEGA)[0]),
    )
    turning = inertia_of(diagonal("d"))
    lost = MU * (M * square(V) + (OMEGA.T * turning * OMEGA)[0])
    damping, mass = DAMPED[0], MASSIVE[0]
    moves = [[damping, mass, Square(e)] for e in V]
    turns = [[damping, j, Square(e)] for j, e in zip(PRINCIPAL.parts, OMEGA, strict=True)]
    yield positive(
        r"In principal axes the loss is positive where the body turns,",
        lost,
        [*moves, *([damping, PRINCIPAL[k], Square(TURNING[k])] for k in range(3))],
    )
    yield positive(
        r"and where it moves.",
        lost,
        [*([damping, mass, Square(speed)] for speed in MOVING.parts), *turns],
    )


def _coasting(pull: Pull, drag: int) -> Proof:
    pulled = pull(STRETCHED, L)
    yield combination(
        r"A spring pulls nowhere along a free shift: $n \cdot F = 2\, (L^{\mathsf T} n) \cdot "
        r"(L^{\mathsf T} e)$.",
        inner(N, pulled),
        contraction(2 * L.T * STRETCHED, FREE),
    )
    yield identity(
        r"So $M\, n \cdot (\dot c + \dot v/\mu) = n \cdot F/\mu = 0$, here times $\mu$: $n \cdot "
        r"(c + v/\mu)$ is constant. The body coasts along $n$ and comes to rest.",
        MU * M * inner(N, V) + inner(N, FORCE - drag * MU * M * V),
        inner(N, FORCE),
    )


def _half(stretched: Any, factor: Any) -> Array:
    return factor * factor.T * stretched


def _transposed(stretched: Any, factor: Any) -> Array:
    return 2 * factor.T * factor * stretched


CLAIM = Claim(
    name="spring_rest",
    title="On general springs every motion comes to rest",
    statement=r"Let $J \succ 0$, $\mu > 0$, $V$ be kinetic energy and springs. Then $\dot V = -\mu "
    r"(M |v|^2 + \omega^{\mathsf T} J \omega)$, and every motion tends to the set of equilibria. "
    r"All sets $\{V \le E\}$ are compact if and only if $S = \sum_i W_i \succ 0$. If $S n = 0$, $n "
    r"\cdot (c + v/\mu)$ is constant.",
    concludes=(1, 2, 3, 4, 5, 6, 7, 8, 9),
    hypotheses=(STIFF, RESISTING, FREE, DAMPED, MASSIVE, PRINCIPAL, TURNING, MOVING),
    setting=(
        r"$M \dot v = F - \mu M v$, $\dot c = v$ and $\dot R = R[\omega]_\times$.",
        r"$J \dot\omega = \tau - \mu J \omega - \omega \times J \omega$.",
        r"$F$ and $\tau$ are the sums over all springs.",
    ),
    source="[Yang2020], the proposition on convergence, carried over; [LaSalle1960]",
    proof=proof,
    controls={
        "drag that drives": Mutation(at=5, proof=lambda: proof(drag=-1)),
        "springs of half the stiffness": Mutation(at=4, proof=lambda: proof(_half)),
        "springs of the matrix L^T L": Mutation(at=4, proof=lambda: proof(_transposed)),
        "ten times the determinant": Mutation(
            at=1,
            proof=lambda: proof(least=10),
            point={entry("s", k): 1 for k in (1, 2, 3)} | {entry("u", 1): 1},
        ),
    },
    not_claimed="That the limit is the optimum, or unstable elsewhere: claim `stable_spurious`. "
    "Nor that it is one equilibrium where they are not isolated.",
    needs=("spring_translation", "properness", "convergence"),
    standard=("Solutions of polynomial differential equations go on while they are bounded.",),
    used_by=("certreg.objective.springs.Springs.best_translation",),
    not_in_coq="Neither that solutions exist nor LaSalle's theorem is proved in Coq.",
)
