"""What the checker must say of a free scale just inside and just outside of its inequalities.

Cases as those of `checker_boundaries`. What is right is found here by exact fractions from the
definitions, about the means or about the origin; no formula is shared with the checker.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from math import isqrt
from typing import TYPE_CHECKING, Any

import certificates as oracle
import numpy as np
from checker_boundaries import (
    NEAR,
    Case,
    around,
    changed,
    dyadic,
    form,
    outcome_of,
    upward,
    value_of,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

Document = dict[str, Any]
AXES, SIDE = oracle.stretched((3, 2, 1)), oracle.stretched((3, 2, -1))
PREFIXES = {
    ("asymmetric", False): b"certreg-similarity/1\0",
    ("asymmetric", True): b"certreg-similarity-rotation/1\0",
    ("symmetric", False): b"certreg-similarity-symmetric/1\0",
    ("symmetric", True): b"certreg-similarity-symmetric-rotation/1\0",
}
MODELS = [*PREFIXES]
GAPS = {"asymmetric": r"delta \(2 v \+ delta\) / Sx", "symmetric": "2 delta"}
RANGES = "claims.scale_lower and scale_upper do not hold"


@dataclass(frozen=True)
class Sums:
    """M, Sx, Sy and K by the definitions; about the origin: each pair also with both signs."""

    mass: Fraction
    x: Fraction
    y: Fraction
    K: Any

    @classmethod
    def of(cls, source: Any, target: Any, weights: Any, *, alone: bool) -> Sums:
        x, y, w = (np.asarray(part, dtype=float) for part in (source, target, weights))
        both = (np.vstack([x, -x]), np.vstack([y, -y]), np.hstack([w, w]))
        rows, half = (both, Fraction(1, 2)) if alone else ((x, y, w), Fraction(1))
        mass, C, S = oracle.exact_moments(*rows)
        _, _, T = oracle.exact_moments(rows[1], rows[0], rows[2])
        x_spread, y_spread = (half * sum(A[k][k] for k in range(3)) for A in (S, T))
        K = oracle.rotation_form([[half * entry for entry in row] for row in C])
        return cls(half * mass, x_spread, y_spread, K)


@dataclass(frozen=True)
class Scaled:
    """A problem, a quaternion and the numbers of a proof."""

    model: tuple[str, bool]
    points: Any
    q: list[int]
    delta: Fraction
    mu: Fraction
    pattern: tuple[int, ...] = (1, 1, 1, 1)

    @property
    def sums(self) -> Sums:
        return Sums.of(*self.points, alone=self.model[1])

    @property
    def v(self) -> Fraction:
        return form(self.sums.K, self.q) / sum(c * c for c in self.q)

    @property
    def bounds(self) -> dict[str, Fraction]:
        """What is proved, exactly; of a root 300 bits, on the side where it is proved."""
        sums, v, delta = self.sums, self.v, self.delta
        if self.model[0] == "asymmetric":
            gap = delta * (2 * v + delta) / sums.x
            return {"gap": gap, "scale_lower": v / sums.x, "scale_upper": (v + delta) / sums.x}
        low = root(sums.y / sums.x)
        return {"gap": 2 * delta, "scale_lower": low, "scale_upper": low + Fraction(1, 2**300)}

    def document(self, **parts: Any) -> Document:
        """The strongest claims that hold, in 200 bits, and others in their place."""
        bounds = self.bounds
        content = oracle.problem_bytes(*self.points)[len(oracle.PREFIX) :]
        scale, alone = self.model
        made = {
            "about": {},
            "claims": {
                "gap": upward(bounds["gap"]),
                "pattern": [*self.pattern],
                "scale_lower": lowered(bounds["scale_lower"]),
                "scale_upper": upward(bounds["scale_upper"]),
                "sin2_half_angle": upward(self.delta / self.mu) if self.mu else None,
                "unique": self.pattern[0] == 1,
            },
            "format": "certreg-certificate/1",
            "kind": "similarity",
            "optimality": {"delta": dyadic(self.delta), "mu": dyadic(self.mu)},
            "pose": self.q,
            "problem": oracle.stated_problem(PREFIXES[self.model] + content, len(self.points[2])),
            "scale": scale,
            **({"rotation_only": True} if alone else {}),
        }
        return changed(made, **parts)


def root(value: Fraction) -> Fraction:
    """From below, to 300 bits behind the point."""
    return Fraction(isqrt((value.numerator << 600) // value.denominator), 2**300)


def lowered(value: Fraction) -> list[int]:
    m, e = upward(-value) if value else (0, 0)
    return [-m, e]


def shifted(points: Any) -> Any:
    """The rows away from their mean."""
    return [[a + b for a, b in zip(row, (1, 2, 4), strict=True)] for row in points]


@cache
def octahedron(model: tuple[str, bool], target: str = "", *, small: bool = False) -> Scaled:
    """K = diag(28, 8, -12, -24), Sx = Sy = 28; mirrored diag(24, 12, -8, -28)."""
    source = np.array(AXES) * (2.0**-30 if small else 1.0)
    to = np.array(SIDE if target else AXES) * (2.0**-30 if small else 1.0)
    unit = Fraction(1, 2**60) if small else Fraction(1)
    return Scaled(model, (source, to, [1.0] * 6), [1, 0, 0, 0], unit / 2**40, 8 * unit)


@cache
def general(model: tuple[str, bool]) -> Scaled:
    """Weights, points off the origin, a quaternion with a residual, delta and mu of many bits."""
    source, target, weights = oracle.random_problem(seed=5, n=7, noise=0.3)
    found = Scaled(model, (source, 3 * target, weights), [1, 0, 0, 0], Fraction(1), Fraction(0))
    values, vectors = np.linalg.eigh(np.array(found.sums.K, dtype=float))
    q = [round(float(c) * 2**20) for c in vectors[:, 3]]
    gap = Fraction(float(values[3] - values[2]))
    return Scaled(
        model, found.points, q, gap / 2**10 + Fraction(1, 2**90), gap / 4 + Fraction(1, 2**200)
    )


def bound_cases() -> Iterator[Case]:
    """Gap and both ends of the scale, at 1 -+ 1e-9 of what is proved; met exactly."""
    for model in MODELS:
        for case in (octahedron(model), general(model), octahedron(model, small=True)):
            name, bounds = f"{model} {len(case.points[2])} {float(case.mu)}", case.bounds
            yield Case(f"{name}", outcome_of(case.document()), "VERIFIED")
            gap = f"claims.gap is less than the proved {GAPS[model[0]]}"
            yield from around(
                f"{name} gap", lambda x, c=case, b=bounds: c.document(gap=upward(b["gap"] / x)), gap
            )
            yield from around(
                f"{name} lower",
                lambda x, c=case, b=bounds: c.document(scale_lower=lowered(b["scale_lower"] * x)),
                f"{RANGES}.*",
            )
            yield from around(
                f"{name} upper",
                lambda x, c=case, b=bounds: c.document(scale_upper=upward(b["scale_upper"] / x)),
                f"{RANGES}.*",
            )
            below = case.document(scale_lower=[-(2**40), 0])
            yield Case(f"{name} lower far below 0", outcome_of(below), "VERIFIED")
            above = case.document(scale_upper=[-(2**40), 0])
            yield Case(f"{name} upper far below 0", outcome_of(above), f"REFUSED: {RANGES}")
    exact = octahedron(("symmetric", False)).document(
        scale_lower=[1, 0], scale_upper=[1, 0], gap=[1, -39]
    )
    yield Case(
        "symmetric, all met exactly", outcome_of(exact), "VERIFIED.*at least 1 and at most 1\\."
    )
    pair = [[2.0, 0, 0], [0, 0, 0]]
    four = Scaled(
        ("asymmetric", True),
        (pair, pair, [1.0] * 2),
        [1, 0, 0, 0],
        Fraction(1, 16),
        Fraction(0),
        (2, 2),
    )
    yield Case(
        "Sx = 4, all met exactly",
        outcome_of(four.document(gap=dyadic(Fraction(129, 1024)))),
        "VERIFIED",
    )
    less = four.document(gap=dyadic(Fraction(129, 1024) - Fraction(1, 2**100)))
    yield Case("Sx = 4, a gap less by one unit", outcome_of(less), "REFUSED: claims.gap")


def sign_cases() -> Iterator[Case]:
    """delta, mu, the pose, an alignment below 0, points that tell no scale, patterns, names."""
    signs = "REFUSED: delta > 0, mu >= 0 and a pose other than 0 needed$"
    for model in MODELS:
        case = octahedron(model)
        for parts in ({"delta": [0, 0]}, {"delta": [-1, 0]}, {"mu": [-1, -90]}, {"pose": [0] * 4}):
            yield Case(
                f"{model} {parts}", outcome_of(case.document(**parts, sin2_half_angle=None)), signs
            )
        off = case.document(pose=[0, 1, 0, 0])
        yield Case(f"{model} pose", outcome_of(off), "REFUSED: delta and mu do not prove")
        angle = case.document(sin2_half_angle=[1, -44])
        yield Case(f"{model} angle", outcome_of(angle), "REFUSED: claims.sin2_half_angle")
        wrong = case.document(pattern=[1, 1, 2])
        yield Case(f"{model} pattern", outcome_of(wrong), "REFUSED: claims.pattern")
        for name in ("both", "", "none"):
            content = oracle.problem_bytes(*case.points)[len(oracle.PREFIX) :]
            for prefix in (b"", PREFIXES[model]):
                problem = oracle.stated_problem(prefix + content, 6)
                renamed = {**case.document(), "scale": name, "problem": problem}
                yield Case(f"{model} {name!r} {prefix!r}", outcome_of(renamed), "REFUSED")
        for other in MODELS:
            if other != model:
                alone = {"rotation_only": other[1] or None}
                text = {**case.document(), "scale": other[0], **alone}
                yield Case(
                    f"{model} as {other}", outcome_of(text), "REFUSED: (data is not|the digest)"
                )
    yield from negative_cases()
    yield from degenerate_cases()


def negative_cases() -> Iterator[Case]:
    """K = diag(28, 8, -12, -24): at e3 v = -24, and v + delta > 28 takes delta > 2 |v|."""
    for alone in (False, True):
        for k, v in ((2, -12), (3, -24)):
            for delta in (28 - v + 1, 64, 2 * -v + 1, 2 * -v):
                q = [int(i == k) for i in range(4)]
                case = octahedron(("asymmetric", alone))
                forged = case.document(
                    pose=q,
                    delta=[delta, 0],
                    mu=[0, 0],
                    sin2_half_angle=None,
                    gap=[1, 60],
                    scale_lower=[-1, 60],
                    scale_upper=[1, 60],
                )
                reason = r"tr\(R\^T C\) < 0" if delta > 28 - v else "delta and mu do not"
                yield Case(
                    f"v = {v}, delta = {delta}, {alone}", outcome_of(forged), f"REFUSED: {reason}"
                )
    case = octahedron(("symmetric", False))
    loose = case.document(
        pose=[0, 0, 0, 1], delta=[53, 0], mu=[0, 0], sin2_half_angle=None, gap=[106, 0]
    )
    yield Case("symmetric, v = -24", outcome_of(loose), "VERIFIED.*bounds nothing")


def degenerate_cases() -> Iterator[Case]:
    point = [[1.0, 2, 3]] * 4
    body = [[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [0, 0, 3]]
    for scale in ("asymmetric", "symmetric"):
        known = octahedron((scale, False)).document(
            sin2_half_angle=None, unique=False, pattern=[4], mu=[0, 0]
        )
        for name, pair, ok in (
            ("source", (point, body), False),
            ("target", (body, point), scale == "asymmetric"),
        ):
            content = oracle.problem_bytes(*pair, [1.0] * 4)[len(oracle.PREFIX) :]
            problem = oracle.stated_problem(PREFIXES[scale, False] + content, 4)
            answer = (
                "VERIFIED.*at least 0 and" if ok else f"REFUSED: all {name} points .* at one point"
            )
            text = {**known, "problem": problem}
            text["claims"] = {**text["claims"], "scale_lower": [0, 0]}
            yield Case(f"{scale}, one {name} point", outcome_of(text), answer)
    origin = {
        **octahedron(("asymmetric", True)).document(
            sin2_half_angle=None, unique=False, pattern=[4], mu=[0, 0]
        )
    }
    content = oracle.problem_bytes([[0.0] * 3] * 4, body, [1.0] * 4)[len(oracle.PREFIX) :]
    origin["problem"] = oracle.stated_problem(PREFIXES["asymmetric", True] + content, 4)
    yield Case(
        "all at the origin", outcome_of(origin), "REFUSED: all source points .* at the origin"
    )


def word_cases() -> Iterator[Case]:
    for model in MODELS:
        case = general(model)
        over = " / s" if model[0] == "symmetric" else ""
        shift, none = ("", ", no translation") if model[1] else (" - t", "")
        told = f"weight x |y - s R x{shift}|^2{over}, s the scale{none}."
        told = "".join("\\" + c if c in "|^.()" else c for c in told)
        yield Case(f"objective {model}", outcome_of(case.document()), f"VERIFIED.*{told}")
        yield Case(
            f"unique {model}",
            outcome_of(case.document()),
            "VERIFIED.*optimum is unique: every other pose with a scale",
        )
        wide = case.document(scale_lower=[1, -3], scale_upper=[8, 0])
        yield Case(
            f"width {model}",
            outcome_of(wide),
            r"VERIFIED.*at least 0\.125 and at most 8\.\nRelative to it, .* are 6\.3e\+1 apart",
        )
        negative = case.document(scale_lower=[-1, 0])
        yield Case(
            f"no width {model}",
            outcome_of(negative),
            r"VERIFIED.*at least 0 and at most \S+\.\nSum of weights",
        )
        thirds = case.document(scale_lower=lowered(case.bounds["scale_lower"] * (1 - NEAR)))
        yield Case(
            f"ends {model}", value_of(lambda checker, d=thirds: ends_hold(checker, d)), "True$"
        )
        yield Case(f"worth {model}", value_of(lambda checker, c=case: agrees(checker, c)), "True$")
        mirrored = octahedron(model, "mirrored")
        yield Case(
            f"worth mirrored {model}",
            value_of(lambda checker, c=mirrored: agrees(checker, c)),
            "True$",
        )


def fine_cases() -> Iterator[Case]:
    """One of delta and mu much finer than the other; worth where the pose is not optimal; radii."""
    tiny = Fraction(1, 2**1000)
    for model in MODELS:
        plain = octahedron(model)
        loose = replace(plain, q=[0, 1, 0, 0], delta=Fraction(21), mu=Fraction(0))
        for name, case in (("plain", plain), ("loose", loose)):
            agreed = value_of(lambda checker, c=case: agrees(checker, c))
            yield Case(f"worth {name} {model}", agreed, "True$")
        for name, case in (
            ("delta", replace(plain, delta=tiny)),
            ("mu", replace(plain, mu=8 + tiny)),
        ):
            yield Case(f"a fine {name} {model}", outcome_of(case.document()), "VERIFIED")
        steady = replace(plain, mu=8 + plain.delta)
        room = 10 * (root(Fraction(3, 4)) - root(4 * plain.delta / 8))
        lever = root(Fraction(168))  # M Sx = M Sy = 6 28
        radii = {"target": room / lever, "both": (root(lever**2 + 6 * room) - lever) / 6}
        for name, radius in radii.items():
            for factor, answer in ((1 - NEAR, "VERIFIED"), (1 + NEAR, "REFUSED: radius is larger")):
                told = {**radii, name: factor * radius}
                told = {k: told[k] * (1 - NEAR / 2 * (k != name)) for k in told}
                told |= {"separation": 20 * (1 - NEAR / 64), "sin_half_angle": Fraction(1, 2)}
                text = steady.document() | {"radius": {k: lowered(x) for k, x in told.items()}}
                yield Case(f"radius {name} {answer} {model}", outcome_of(text), answer)


def ends_hold(checker: Any, document: Document) -> bool:
    """Whether the printed ends of the scale are outside of those that are claimed."""
    words = next(t for t in checker.check(oracle.dump(document)).theorems if "The scale of" in t)
    low, high = (Fraction(word.rstrip(".")) for word in (words.split()[-5], words.split()[-1]))
    claims = [document["claims"][name] for name in ("scale_lower", "scale_upper")]
    (a, e), (b, f) = claims
    return low <= a * Fraction(2) ** e and b * Fraction(2) ** f <= high


def agrees(checker: Any, case: Scaled) -> bool:
    """The numbers of what is proved, held against the definitions."""
    worth, sums, v = checker.check(oracle.dump(case.document())).worth, case.sums, case.v
    top, gap, sharp = v + case.delta, case.bounds["gap"], 1 + Fraction(1, 10**18)
    squares = sum(entry**2 for row in sums.K for entry in row)
    if case.model[0] == "asymmetric":
        exact = worth.objective == sums.y - v * v / sums.x
        exact = exact and worth.minimum == max(sums.y - top * top / sums.x, 0)
        exact = exact and worth.share == gap * sums.x / max(v * v, squares / 12)
    else:
        most, least = worth.objective / 2 + v, worth.minimum / 2 + top
        product = sums.x * sums.y
        exact = product < most * most < product * sharp
        slack = Fraction(1, 10**17)
        low = product * (1 - slack) < least * least < product
        exact = exact and (worth.minimum == 0 or (low and worth.minimum > 0))
        exact = exact and case.delta**2 < worth.share**2 * squares < case.delta**2 * sharp
    length = gap / sums.mass < worth.length**2 < gap / sums.mass * sharp
    return bool(exact and length and worth.gap == gap and worth.weight == sums.mass)


@cache
def _cases() -> tuple[Case, ...]:
    return (*bound_cases(), *sign_cases(), *word_cases(), *fine_cases())


def similarity_cases() -> list[Case]:
    """All cases of a free scale."""
    return list(_cases())
