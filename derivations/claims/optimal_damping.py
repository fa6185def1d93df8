"""Claim: the damping under which the slowest mode at the optimum decays fastest."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import sympy

from certreg.equilibrium.stability import TRANSLATION_STIFFNESS

from ..algebra import Square, facts, identity, modulo, nonnegative, positive, refuting
from ..hypothesis import Point, Standing, equation, nonnegative_by, positive_by
from ..kernel import Claim, Mutation, Proof, Step
from ..linearisation import hessian
from ..moments import inertia_of
from ..motion import DAMPING, Body, State, rate
from ..notation import Matrix, scalar, symmetric
from ..rings import Surd
from .unstable_count import CLAIM as UNSTABLE
from .unstable_count import W_ROOT

STIFFNESS = Fraction(TRANSLATION_STIFFNESS)  # a power of two: exact
MU, K, W = DAMPING, scalar("k"), scalar("w")


def _overdamped(point: Point) -> Mapping[Any, Any]:
    """Rational mu and w with mu^2 - w^2 = 4 k^2 = (mu - w)(mu + w)."""
    share = abs(point[MU]) + 1
    return {MU: share + point[K] ** 2 / share, W: point[K] ** 2 / share - share}


CASE = Standing.CASE
UNIQUE = positive_by("The optimum is unique, $g_{\\min} > 0$, and so $k > 0$.", K)
SWING = equation(
    r"$\beta^2 = g - \mu^2/4$.",
    scalar("beta"),
    2,
    scalar("g") - MU**2 / 4,
    standing=CASE,
    solves=(scalar("g"),),
)
FAST = nonnegative_by(
    r"$e \geq 0$: $g = k^2 + e$ is not less than $k^2$.", scalar("e"), standing=CASE
)
LESS = positive_by(r"Less damping, $\mu < \mu^*$.", 2 * K - MU, standing=CASE)
OVERDAMPED = nonnegative_by(r"A root, $w \geq 0$.", W, standing=CASE)
W_SQUARED = equation(
    r"$w^2 = \mu^2 - 4k^2$.", W, 2, MU**2 - 4 * K**2, standing=CASE, prepare=_overdamped
)
CREEPING = positive_by(
    r"More damping: $w > 0$ and $r = (\mu - w)/2 > 0$.", [W, MU - W], standing=CASE
)
NOISE_FREE = equation("No noise: $k^2 = 2$.", K, 2, 2, standing=CASE)


def proof(
    factor: int = 2, translation: Fraction = STIFFNESS, *, slow: int = -1, noise_free: int = 2
) -> Proof:
    """The rate of one mode, then all modes at, below and above mu*, and the case without noise."""
    yield _translation(sympy.Rational(translation))
    yield from _one_mode(slow)
    excess = scalar("e")
    yield nonnegative(
        r"Let $m = \min(2, g_{\min}) > 0$ be the least of all $g$, $k = \sqrt{m}$ and "
        r"$\mu^* = 2k$. At $\mu = \mu^*$ a mode with $g = k^2 + e$, $e \geq 0$, has "
        r"$4g - \mu^2 = 4e \geq 0$: no mode is overdamped, and each has the rate "
        r"$\mu^*/2 = k$. For $e = 0$ the two roots coincide.",
        4 * (K**2 + excess) - (factor * K) ** 2,
        [[4, FAST[0]]],
    )
    yield positive(
        r"With less damping every mode is slower: its rate is $\mu/2$ or, if it is overdamped, "
        r"$(\mu - w)/2$, and $k$ exceeds either by at least $(\mu^* - \mu)/2 > 0$.",
        K - (MU - W) / 2,
        [
            [sympy.Rational(1, 2), LESS[0]],
            [sympy.Rational(1, 2), OVERDAMPED[0]],
        ],
    )
    slower = (MU + slow * W) / 2
    yield modulo(
        r"With more damping the mode of $g = m = k^2$ is overdamped: "
        r"$w = \sqrt{\mu^2 - 4k^2} > 0$. Its rate $r = (\mu - w)/2 > 0$ obeys $k^2 - r^2 = "
        r"r w > 0$, so $r < k$: the body creeps. "
        r"Hence the slowest rate is largest at $\mu^* = 2\sqrt{\min(2, g_{\min})}$ and nowhere "
        r"else, and its value there is $\sqrt{\min(2, g_{\min})}$.",
        K**2 - slower**2,
        slower * W,
        [W_SQUARED],
    )
    yield positive(
        r"Here $r w > 0$, so that $k^2 > r^2$;",
        (MU - W) / 2 * W,
        [[sympy.Rational(1, 2), CREEPING[1], CREEPING[0]]],
    )
    yield positive(
        r"and $r$ is positive indeed, as $(\mu - w)(\mu + w) = 4k^2 > 0$.",
        4 * K**2,
        [[4, Square(UNIQUE[0])]],
    )
    yield _translation_counts(translation)
    yield from _without_noise(noise_free)


def _translation(stiffness: Any) -> Step:
    state = State()
    return identity(
        r"The translation obeys $\ddot c + \mu \dot c + 2 c = 0$, exactly and everywhere, so its "
        r"three modes have $g = 2$. The modes of the rotation have the eigenvalues $g$ of the "
        r"pencil $(G, J)$ (claim `unstable_count`), positive where the optimum is unique. All six "
        r"are of the form $s^2 + \mu s + g = 0$ with $g > 0$.",
        rate(state, Body())[12:15],
        list(-stiffness * state.c - MU * state.v),
    )


def _one_mode(slow: int) -> Proof:
    g, s, beta = scalar("g"), scalar("s"), scalar("beta")
    one, turned = sympy.eye(2), beta * Matrix([[0, -1], [1, 0]])  # 1 and i beta
    yield modulo(
        r"A mode with $\mu^2 < 4g$ swings: with $\beta = \sqrt{g - \mu^2/4}$ its roots are $s = "
        r"-\mu/2 \pm i\beta$, because $(s + \mu/2 - i\beta)(s + \mu/2 + i\beta) = s^2 + \mu s + "
        r"g$, here with a matrix for $i$. Both have the real part $-\mu/2$: it decays at the rate "
        r"$\mu/2$.",
        ((s + MU / 2) * one - turned) * ((s + MU / 2) * one + turned),
        (s**2 + MU * s + g) * one,
        [SWING],
    )
    quick = -slow
    yield modulo(
        r"A mode with $\mu^2 \geq 4g$ does not: with $w = \sqrt{\mu^2 - 4g} \geq 0$ its roots are "
        r"$-(\mu - w)/2$ and $-(\mu + w)/2$. The rate of the slower one is $(\mu - w)/2 \leq "
        r"\mu/2$, and it is positive because $\mu^2 - w^2 = 4g > 0$.",
        [(s + (MU + slow * W) / 2) * (s + (MU + quick * W) / 2), MU**2 - W**2],
        [s**2 + MU * s + g, 4 * g],
        [W_ROOT],
    )


def _translation_counts(translation: Fraction) -> Step:
    least, damping, w = Fraction(9, 4), Fraction(3), Fraction(1)
    return facts(
        r"The minimum with $2$ cannot be left out. Take $g_{\min} = 9/4$: the rotation alone would "
        r"ask for $\mu = 2 \sqrt{9/4} = 3$; then $w = \sqrt{3^2 - 4 \cdot 2} = 1$, and the "
        r"translation decays at the rate $(3 - 1)/2 = 1$. With $\mu^* = \sqrt{8}$ everything "
        r"decays at the rate $\sqrt{2} > 1$.",
        [damping**2, w**2, (damping - w) / 2, ((damping - w) / 2) ** 2 < translation],
        [4 * least, damping**2 - 4 * translation, Fraction(1), True],
    )


def _without_noise(noise_free: int) -> Proof:
    scatter, g = symmetric("S"), scalar("g")
    J = inertia_of(scatter)
    optimum = State(R=sympy.eye(3)), Body(cross=scatter)
    yield identity(
        r"Without noise $R^{\mathsf T} C = S_2$ at the optimum and $G = 2J$ (claim `hessian`), so "
        r"$G - g J = (2 - g) J$: the pencil has the eigenvalue $2$ three times, whatever the shape "
        r"of the cloud, and rotation and translation swing alike.",
        Matrix(hessian(*optimum)) - g * J,
        (noise_free - g) * J,
    )
    yield modulo(
        r"Then $m = 2$ and $\mu^* = 2\sqrt{2} = \sqrt{8}$: with $k^2 = 2$, $(2k)^2 = 8$.",
        (2 * K) ** 2,
        8,
        [NOISE_FREE],
    )


def _slower() -> Step:
    """All g = 1: at mu = 1 every mode decays at the rate 1/2, at mu = 2 at the rate 1."""
    return refuting(
        r"Where all $g$ are $1$, $\mu = \sqrt m = 1$ gives every mode the rate $\mu/2 = \tfrac12$, "
        r"and $\mu = 2$ gives it the rate $1$: it is not the best.",
        [max(Fraction(1, 2), Fraction(2, 2))],
        [Fraction(1, 2)],
    )


CLAIM = Claim(
    name="optimal_damping",
    title="The best damping",
    statement=r"The translation obeys $\ddot c + \mu\dot c + 2c = 0$. Let the optimum be unique "
    r"and $g_{\min} > 0$ the least eigenvalue of the pencil "
    r"$(G, J)$ there. The rate of the slowest mode of the linearised dynamics, as a function of "
    r"the damping $\mu > 0$, has its only maximum at $\mu^* = 2 \sqrt{\min(2, g_{\min})}$, with "
    r"the value $\sqrt{\min(2, g_{\min})}$. Without noise $\mu^* = \sqrt{8}$.",
    concludes=(1, 2, 3, 4, 5, 6, 7, 8, 10, 11),
    hypotheses=(UNIQUE, SWING, W_ROOT, FAST, LESS, OVERDAMPED, W_SQUARED, CREEPING, NOISE_FREE),
    inherits=(UNSTABLE,),
    source="ours; [Yang2020] does not state its damping",
    proof=proof,
    witness={K: Surd(0, 1, 2)},
    controls={
        "mu* = sqrt(m)": Mutation(at=4, proof=lambda: proof(factor=1), instance=_slower),
        "translation with g = 1": Mutation(at=1, proof=lambda: proof(translation=Fraction(1))),
        "the rate of the faster root": Mutation(at=6, proof=lambda: proof(slow=1)),
        "G = J without noise": Mutation(at=10, proof=lambda: proof(noise_free=1)),
    },
    not_claimed=r"That it is the fastest far from the optimum, or in steps of an integrator. The "
    r"rate is that of the exponential: at $\mu^*$ the slowest mode has a double root and decays "
    r"like $(1 + \text{const}\, t)\, e^{-kt}$. The energy decays at twice the rate.",
    needs=("characteristic_polynomial", "unstable_count", "hessian"),
    runs=("derivations.motion.rate",),
    used_by=("certreg.dynamics.simulation.optimal_damping",),
    not_in_coq="Nothing in Coq speaks of rates of decay.",
)
