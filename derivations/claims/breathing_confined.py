"""Claim: a body with less energy than Syy keeps its scale away from 0, and comes to rest."""

from __future__ import annotations

import sympy

from ..algebra import Square, combination, identity, nonnegative, positive, quoted
from ..breathing_motion import BreathingState, own_size, rate
from ..hypothesis import Standing, nonnegative_by, positive_by, vanishing
from ..kernel import Claim, Mutation, Proof
from ..motion import DAMPING, Body
from ..notation import entry, inner, scalar, square, vector, vee

M, S, P, SIZE, TARGET = (scalar(name) for name in ("M", "s", "p", "S_xx", "S_yy"))
C, V, SPIN = vector("c"), vector("v"), scalar("e")
ALIGNED, FIRST, START = scalar("a"), entry("l", 1), entry("V", 0)
LEVELS = [entry("l", k) for k in (2, 3)]
POTENTIAL = M * square(C) + TARGET + S**2 * SIZE - 2 * S * ALIGNED
ENERGY = POTENTIAL + (M * square(V) + S**2 * SPIN + SIZE * P**2) / 2
HALF = sympy.Rational(1, 2)

HEAVY = nonnegative_by(r"$M \ge 0$: masses.", M, example={V[0]: 1, M: -1})
SOURCE = nonnegative_by(r"$S_{xx} \ge 0$: a sum of squares.", SIZE, example={P: 1})
TURNING = nonnegative_by(
    r"$e = \omega^{\mathsf T} J \omega \ge 0$.",
    SPIN,
    example={S: 1, SPIN: -1},
)
TOP = nonnegative_by(
    r"$\lambda_1$ is the largest eigenvalue of $K$: $a = q^{\mathsf T} K q \le \lambda_1$.",
    FIRST - ALIGNED,
    prepare=lambda point: {FIRST: abs(point[ALIGNED]) + 1},
)
UPRIGHT = nonnegative_by(r"Up to that moment $s \ge 0$.", S, standing=Standing.CASE)
BELOW = positive_by(
    r"$V < S_{yy}$ at the start.",
    TARGET - START,
    standing=Standing.CASE,
    prepare=lambda point: {TARGET: abs(point[START]) + point[START] + 1},
)
FALLS = nonnegative_by(
    r"The energy never rises, $V \le V_0$.",
    START - ENERGY,
    standing=Standing.CASE,
    prepare=lambda point: {START: abs(point[START]) + 1000},
)
LOWEST = nonnegative_by(
    r"$\lambda_2 \ge \lambda_j$.",
    LEVELS[0] - LEVELS[1],
    standing=Standing.CASE,
    prepare=lambda point: {LEVELS[0]: abs(point[LEVELS[1]]) + 1},
)
COUNTS = nonnegative_by(
    r"$\lambda_j \ge 0$.", LEVELS[1], standing=Standing.CASE, example={LEVELS[1]: -1}
)
STATE, BODY = BreathingState(), Body()
RESTING = vanishing(
    r"The rotation is an equilibrium: $R^{\mathsf T} C$ is symmetric.",
    vee(STATE.R.T * BODY.cross - BODY.cross.T * STATE.R),
    standing=Standing.CASE,
    solves=(BODY.cross[0, 1], BODY.cross[0, 2], BODY.cross[1, 2]),
)
OPPOSED = positive_by(r"$n = -\lambda_j > 0$.", scalar("n"), standing=Standing.CASE)


def proof(*, share: int = 2, squares: int = 1, pulled: int = 1) -> Proof:
    """The energy at s = 0; the least scale; where motions end; a motion that collapses."""
    yield nonnegative(
        r"At $s = 0$ the energy is at least $S_{yy}$: $V - S_{yy} = M|c|^2 + \tfrac12 M|v|^2 + "
        r"\tfrac12 S_{xx}\dot s^2$.",
        ENERGY.subs(S, 0) - TARGET,
        [
            *([HEAVY[0], Square(e)] for e in C),
            *([HALF, HEAVY[0], Square(e)] for e in V),
            [HALF, SOURCE[0], Square(P)],
        ],
    )
    yield nonnegative(
        r"And where $s \ge 0$, $V \ge S_{yy} - 2 s \lambda_1$.",
        ENERGY - TARGET + share * S * FIRST,
        [
            *([HEAVY[0], Square(e)] for e in C),
            *([HALF, HEAVY[0], Square(e)] for e in V),
            [HALF, SOURCE[0], Square(P)],
            [SOURCE[0], Square(S)],
            [HALF, TURNING[0], Square(S)],
            [2, UPRIGHT[0], TOP[0]],
        ],
    )
    yield positive(
        r"The energy never rises (claim `breathing_motion`), so that $2 s \lambda_1 \ge S_{yy} - V "
        r"\ge S_{yy} - V_0 > 0$ from the start on: $s$ stays above $(S_{yy} - V_0)/(2\lambda_1)$, "
        r"a positive number, as $\lambda_1 > 0$ then; it never comes to $0$, nor through it.",
        2 * S * FIRST,
        [
            [BELOW[0]],
            [FALLS[0]],
            *([HEAVY[0], Square(e)] for e in C),
            *([HALF, HEAVY[0], Square(e)] for e in V),
            [HALF, SOURCE[0], Square(P)],
            [SOURCE[0], Square(S)],
            [HALF, TURNING[0], Square(S)],
            [2, UPRIGHT[0], TOP[0]],
        ],
    )
    yield quoted(
        r"So, if $J \succ 0$ and $\mu > 0$, the motion exists for all time: the states with $s \ge "
        r"(S_{yy} - V_0)/(2\lambda_1)$ and $V \le V_0$ are a compact set, as $c$, $v$, $\dot s$, "
        r"$s$ and $\omega$ are bounded on it. By LaSalle's invariance principle it tends to the "
        r"equilibria with $s > 0$ and an energy of at most $V_0$.",
        theorem="LaSalle's principle",
        source="[LaSalle1960]",
    )
    yield nonnegative(
        r"These have the energies $S_{yy} - \lambda_j^2/S_{xx}$, and among those that are not "
        r"optimal the lowest is that of $\lambda_2$, if it is positive: $\lambda_2^2 \ge "
        r"\lambda_j^2$. So a state with $s > 0$ and $V < S_{yy} - \max(\lambda_2, 0)^2/S_{xx}$ "
        r"ends at the optimum, where $\lambda_1 > \lambda_2$.",
        squares * LEVELS[0] ** 2 - LEVELS[1] ** 2,
        [[LOWEST[0], LOWEST[0]], [2, COUNTS[0], LOWEST[0]]],
    )
    yield from _collapse(pulled)


def _collapse(pulled: int) -> Proof:
    at_rest = dict.fromkeys(STATE.omega, 0)
    found = rate(STATE, BODY).subs(at_rest)
    inverse, own, b = scalar("u"), scalar("w"), vector("b")
    found = found.xreplace({1 / STATE.scale: inverse, 1 / own_size(BODY): own})
    yield combination(
        r"The bound is needed. Released at rest at an equilibrium rotation, the body does not "
        r"turn:",
        inner(b, found[16:19, :]),
        [
            (2 * inverse * e, part)
            for e, part in zip(BODY.inertia_inverse.T * b, RESTING.parts, strict=True)
        ],
    )
    yield identity(
        r"its scale obeys $\ddot s = -2s + 2\lambda_j/S_{xx} - \mu\dot s$ (over $M$).",
        found[19],
        -2 * STATE.scale + 2 * pulled * own * inner(STATE.R, BODY.cross) - DAMPING * STATE.growth,
    )
    yield positive(
        r"With $\lambda_j < 0$, $n = -\lambda_j > 0$, as long as $s \ge 0$ the speed $-\dot s - "
        r"\mu s$ grows at the rate $2 s + 2n/S_{xx}$, here times $S_{xx}$, bounded away from $0$: "
        r"the scale falls to $0$ in finite time, and its energy is $V \ge S_{yy}$ all the way.",
        2 * S * SIZE + 2 * OPPOSED.values[0],
        [[2, UPRIGHT[0], SOURCE[0]], [2, OPPOSED[0]]],
    )


CLAIM = Claim(
    name="breathing_confined",
    title="A body with little energy does not collapse",
    statement=r"Let $s > 0$ and $V < S_{yy}$ at the start, $\mu > 0$. Then for all times $$s \ge "
    r"\frac{S_{yy} - V_0}{2\lambda_1} > 0,$$ the motion exists for all times, and if $J \succ 0$ "
    r"it tends to the equilibria with $s > 0$. If $V_0 < S_{yy} - \max(\lambda_2, 0)^2/S_{xx}$ and "
    r"$\lambda_1 > \lambda_2$ it ends at the optimum. At an equilibrium rotation with $\lambda_j < "
    r"0$, released at rest, the scale falls to $0$ in finite time.",
    concludes=(1, 2, 3, 5, 6, 7, 8),
    hypotheses=(
        HEAVY,
        SOURCE,
        TURNING,
        TOP,
        UPRIGHT,
        BELOW,
        FALLS,
        LOWEST,
        COUNTS,
        RESTING,
        OPPOSED,
    ),
    setting=("The motion is the exact one of claim `breathing_motion`; energies as there.",),
    source="ours; [LaSalle1960]",
    proof=proof,
    witness=dict.fromkeys((S, ALIGNED, FIRST, TARGET, scalar("n")), 1),
    controls={
        "a body that keeps twice the scale": Mutation(
            at=2,
            proof=lambda: proof(share=1),
            point={M: 1, S: 1, FIRST: 1, ALIGNED: 1},
        ),
        "a barrier of no height": Mutation(
            at=5,
            proof=lambda: proof(squares=0),
            point={LEVELS[0]: 1, LEVELS[1]: 1},
        ),
        "twice the pull of the springs": Mutation(at=7, proof=lambda: proof(pulled=2)),
    },
    not_claimed="That a body with more energy collapses.",
    needs=("breathing_motion", "breathing_equilibria", "properness", "convergence"),
    standard=("Solutions of differential equations go on while they stay in a compact set.",),
    used_by=("certreg.registration.simulation.never_collapses",),
    not_in_coq="All of it.",
)
