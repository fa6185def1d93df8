"""What the checker must say just inside and just outside of each of its inequalities.

A case asks one question of a checker, given as a module, so that the same table judges the shipped
file and its mutants. What is right follows from `certificates`, by definitions, or is plain from
the example: the stretched octahedron has C = diag(18, 8, 2), so K = diag(28, 8, -12, -24), and
J = diag(10, 20, 26).
"""

from __future__ import annotations

import base64
import contextlib
import errno
import io
import json
import math
import os
import re
import struct
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import chain
from math import isqrt
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest import mock

import certificates as oracle
import numpy as np

Certificate = dict[str, Any]
Ask = Callable[[Any], str]
NEAR = Fraction(1, 2**30)  # just inside and outside: 1 -+ 1e-9
AXES = oracle.stretched((3, 2, 1))
DELTA = [1, -40]
NOT_THEIRS = r"REFUSED: the digest is not theirs \(weights not given are 1\)$"


@dataclass(frozen=True)
class Case:
    """A question to a checker, and a pattern that its answer matches from the start."""

    name: str
    ask: Ask
    answer: str

    def passes(self, checker: Any) -> bool:
        """Whether the checker answers rightly; one that raises does not."""
        try:
            return re.match(self.answer, self.ask(checker), re.DOTALL) is not None
        except Exception:  # noqa: BLE001  (the checker may be any mutant)
            return False


def outcome_of(content: bytes | Certificate, clouds: Any = None, **limits: int) -> Ask:
    """The checker's outcome in words, with other limits if any are told."""
    content = content if isinstance(content, bytes) else oracle.dump(content)

    def ask(checker: Any) -> str:
        kept = {name: getattr(checker, name) for name in limits}
        vars(checker).update(limits)
        try:
            outcome = checker.check(content, clouds)
        finally:
            vars(checker).update(kept)
        whole = outcome.verified == (not outcome.reason) == bool(outcome.theorems)
        words = "\n".join(outcome.theorems) if outcome.verified else outcome.reason
        return ("VERIFIED\n" if outcome.verified else "REFUSED: ") + words if whole else "torn"

    return ask


def value_of(question: Callable[[Any], object]) -> Ask:
    return lambda checker: repr(question(checker))


def dyadic(value: Fraction) -> list[int]:
    """[m, e] of a rational whose denominator is a power of two."""
    assert value.denominator.bit_count() == 1
    return [value.numerator, 1 - value.denominator.bit_length()]


def upward(value: Fraction, bits: int = 200) -> list[int]:
    """The least dyadic of so many bits that is at least the value."""
    e = value.numerator.bit_length() - value.denominator.bit_length() - bits
    return [-((-value) // Fraction(2) ** e), e]


def changed(certificate: Certificate, **parts: Any) -> Certificate:
    """With other entries, by their names, wherever these stand."""
    found = json.loads(oracle.dump(certificate))
    places = [found, *(part for part in found.values() if isinstance(part, dict))]
    for name, value in parts.items():
        path = name.split("__")
        place = found[path[0]] if len(path) > 1 else next(p for p in places if path[0] in p)
        place[path[-1]] = value
    return found


def around(name: str, parts: Callable[[Fraction], Certificate], refusal: str) -> Iterator[Case]:
    """Two cases of certificates at 1 -+ 1e-9, refused where the factor is above 1."""
    yield Case(f"{name}, inside", outcome_of(parts(1 - NEAR)), "VERIFIED")
    yield Case(f"{name}, outside", outcome_of(parts(1 + NEAR)), f"REFUSED: {refusal}$")


def threshold(holds: Callable[[Fraction], bool], low: Fraction, high: Fraction) -> Fraction:
    """Where a statement that holds at `low` and not at `high` ceases to, to 80 bits; dyadic."""
    assert holds(low)
    assert not holds(high)
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


# --- The examples ---------------------------------------------------------------------------------


def axes(source: Any = AXES, target: Any = AXES, weights: Any = None) -> Certificate:
    """The stretched octahedron: delta = 2^-40, mu = 10, all else as strong as they prove."""
    certificate = oracle.produce(source, target, weights, pattern=[1, 1, 1, 1])
    return stated(changed(certificate, pose=[1, 0, 0, 0]), Fraction(1, 2**40), Fraction(10))


def stated(certificate: Certificate, delta: Fraction, mu: Fraction) -> Certificate:
    """With this delta and mu, and the least bounds that follow."""
    sin2 = upward(delta / mu) if mu else None
    bounds = {"delta": dyadic(delta), "mu": dyadic(mu), "gap": dyadic(2 * delta)}
    return changed(certificate, **bounds, sin2_half_angle=sin2)


@dataclass(frozen=True)
class Example:
    """A certificate of points in general position, with its exact K and J."""

    certificate: Certificate
    K: Any
    J: Any
    q: list[int]
    v: Fraction
    gap: Fraction  # about l1 - l2

    @classmethod
    def made(cls) -> Example:
        source, target, weights = oracle.random_problem(seed=11, n=6, noise=0.3)
        source, target = source * 2.0**-20, target * 2.0**20
        found = oracle.produce(source, target, weights)
        _, C, S = oracle.exact_moments(source, target, weights)
        K, trace = oracle.rotation_form(C), S[0][0] + S[1][1] + S[2][2]
        J = [[trace * (i == j) - S[i][j] for j in range(3)] for i in range(3)]
        values, vectors = np.linalg.eigh(np.array(K, dtype=float))
        q = [round(float(c) * 2**20) for c in vectors[:, 3]]  # its residual is seen
        gap = Fraction(float(values[3] - values[2]))
        return cls(changed(found, pose=q), K, J, q, form(K, q) / sum(c * c for c in q), gap)

    def proves(self, delta: Fraction, mu: Fraction) -> bool:
        return oracle.positive_definite(oracle.optimality_matrix(self.K, self.q, delta, mu))

    def proves_dual(self, nu: Fraction) -> bool:
        return oracle.positive_definite(
            [[nu * (i == j) - self.K[i][j] for j in range(4)] for i in range(4)]
        )


def form(A: Any, v: list[int]) -> Fraction:
    return sum((A[i][j] * a * b for i, a in enumerate(v) for j, b in enumerate(v)), Fraction(0))


# --- What is proved -------------------------------------------------------------------------------

OPTIMAL = "delta and mu do not prove the pose optimal"
SIGNS = "delta > 0, mu >= 0 and a pose other than 0 needed"
BASIN = "claims.basin is not proved of the state in basin"


def optimality_cases() -> Iterator[Case]:
    good, tiny = axes(), Fraction(1, 2**40)
    yield Case("the octahedron", outcome_of(good), "VERIFIED")
    for name, mu in (("below", 20 + tiny - NEAR), ("at", 20 + tiny), ("above", 20 + tiny + NEAR)):
        answer = "VERIFIED" if name == "below" else f"REFUSED: {OPTIMAL}$"
        yield Case(f"mu {name} the spectral gap", outcome_of(stated(good, tiny, mu)), answer)
    least = stated(good, Fraction(1, 2**32768), Fraction(10))
    yield Case("the least delta", outcome_of(changed(least, sin2_half_angle=None)), "VERIFIED")
    for name, parts in {
        "delta 0": {"delta": [0, 0]},
        "delta below 0": {"delta": [-1, -200], "mu": [0, 0]},
        "mu below 0": {"mu": [-1, -200], "sin2_half_angle": None},
        "pose 0": {"pose": [0, 0, 0, 0]},
    }.items():
        yield Case(name, outcome_of(changed(good, **parts)), f"REFUSED: {SIGNS}$")
    without = changed(good, mu=[0, 0], sin2_half_angle=None, delta=[21, 0], gap=[42, 0])
    yield Case("mu 0", outcome_of(without), "VERIFIED")
    for k in range(4):  # K = diag(28, 8, -12, -24): only the first is optimal
        pose = [int(i == k) for i in range(4)]
        answer = "REFUSED: delta and mu" if k else "VERIFIED"
        yield Case(f"pose e{k}", outcome_of(changed(good, pose=pose)), answer)


def modulus_cases() -> Iterator[Case]:
    """What is not 0, but is modulo the checker's prime: the exact numbers decide."""
    prime = 2**31 - 1
    for d in ((prime + 1, 1, 3), (prime, prime + 2, 5)):
        C = [[d[i] * (i == j) for j in range(3)] for i in range(3)]
        simple = value_of(lambda checker, C=C: checker.multiplicities(C))
        yield Case(f"multiplicities of {d}", simple, r"\[1, 1, 1, 1\]$")
    heavy = oracle.with_problem(axes(), oracle.problem_bytes(AXES, AXES, [float(prime)] * 6))
    yield Case("weights that are 0 modulo the prime", outcome_of(heavy), "VERIFIED")


def leading_cases() -> Iterator[Case]:
    """Matrices 2^s B + E, E >= 0, that B tells wrongly: E takes 2 2^s along (1, -1, 1, -1)."""
    signs, size, s = (1, -1, 1, -1), 2**255, 50  # of BITS + s bits
    for name, along, definite in (("inside", 2, "True"), ("outside", 1, "False")):
        B = [
            [
                size * (i // 2 == j // 2) + (along + (along == 1 and i < 3)) * (i == j)
                for j in range(4)
            ]
            for i in range(4)
        ]
        A = [
            [(B[i][j] << s) + (2**s - 1) * (signs[i] != signs[j]) for j in range(4)]
            for i in range(4)
        ]
        yield Case(
            f"leading bits, {name}",
            value_of(lambda checker, A=A: checker.definite(A)),
            definite + "$",
        )


def general_cases(example: Example) -> Iterator[Case]:
    """Points in general position, a quaternion whose residual matters."""
    mu = threshold(lambda x: x < example.gap / 2, Fraction(0), example.gap)
    least = threshold(lambda x: not example.proves(x, mu), Fraction(0), example.gap)
    yield from around(
        "delta", lambda x: stated(example.certificate, upward_value(least / x), mu), OPTIMAL
    )
    most = threshold(lambda x: example.proves(4 * least, x), mu, 4 * example.gap)
    yield from around(
        "mu", lambda x: stated(example.certificate, 4 * least, upward_value(most * x)), OPTIMAL
    )
    smallest = threshold(lambda x: not example.proves(x, Fraction(0)), Fraction(0), 8 * example.gap)
    loose = changed(example.certificate, mu=[0, 0], sin2_half_angle=None)
    yield from around(
        "delta without mu",
        lambda x: changed(
            loose, delta=upward(smallest / x), gap=upward(2 * upward_value(smallest / x))
        ),
        OPTIMAL,
    )
    good = stated(example.certificate, 4 * least, mu)
    top = threshold(lambda x: not example.proves_dual(x), example.v, 2 * abs(example.v) + 1)
    yield from around(
        "nu",
        lambda x: changed(good, sdp={"nu": upward(top / x)}),
        r"sdp\.nu bounds nothing",
    )


def upward_value(value: Fraction) -> Fraction:
    m, e = upward(value)
    return m * Fraction(2) ** e


def claim_cases() -> Iterator[Case]:
    good = axes()
    delta, mu = Fraction(1, 2**40), Fraction(10)
    below = "is below the proved bound"
    yield from around(
        "gap",
        lambda x: changed(good, gap=upward(2 * delta / x)),
        rf"claims\.gap {below} 2 delta",
    )
    yield from around(
        "sin2",
        lambda x: changed(good, sin2_half_angle=upward(delta / mu / x)),
        rf"claims\.sin2_half_angle {below} delta/mu",
    )
    exact = stated(good, delta, Fraction(16))
    equal = {"gap": [1, -39], "sin2_half_angle": [1, -44]}
    yield Case("bounds met exactly", outcome_of(changed(exact, **equal)), "VERIFIED")
    for name, (_, e) in equal.items():
        less = changed(exact, **{**equal, name: [2**200 - 1, e - 200]})
        yield Case(f"{name} less one unit", outcome_of(less), rf"REFUSED: claims\.{name} {below}")
    no_mu = changed(good, mu=[0, 0], delta=[21, 0], gap=[42, 0], sin2_half_angle=[1, 300])
    yield Case("sin2 without mu", outcome_of(no_mu), r"REFUSED: claims\.sin2_half_angle")
    yield Case("no sin2", outcome_of(changed(good, sin2_half_angle=None)), "VERIFIED")
    for claims, answer in (
        ({"unique": False}, "VERIFIED"),
        ({"unstable": None}, "VERIFIED"),
        ({"unstable": [0, 1, 2, 2]}, r"REFUSED: claims\.unstable is wrong or unproved"),
        ({"unstable": [0, 1, 2]}, r"REFUSED: claims\.unstable is wrong or unproved"),
        ({"unstable": []}, r"REFUSED: claims\.unstable .* \[0, 1, 2, 3\]$"),
        ({"pattern": [1, 1, 2]}, r"REFUSED: claims\.pattern .* \[1, 1, 1, 1\]$"),
        ({"pattern": []}, r"REFUSED: claims\.pattern"),
    ):
        yield Case(f"claims {claims}", outcome_of(changed(good, **claims)), answer)
    yield from dual_cases(good)


def dual_cases(good: Certificate) -> Iterator[Case]:
    yield Case("nu at l1", outcome_of(changed(good, sdp={"nu": [28, 0]})), "REFUSED: sdp.nu bounds")
    nu = 28 * (1 + NEAR)
    yield from around(
        "nu of the octahedron",
        lambda x: changed(good, sdp={"nu": dyadic(28 * (2 - x))}),
        r"sdp\.nu bounds nothing",
    )
    bounded = changed(good, sdp={"nu": dyadic(nu)})
    yield Case("dual gap exact", outcome_of(changed(bounded, sdp_gap=dyadic(2 * (nu - 28)))), "V")
    yield from around(
        "dual gap",
        lambda x: changed(bounded, sdp_gap=upward(2 * (nu - 28) / x)),
        r"claims\.sdp_gap is below the proved bound 2 \(nu - v\)",
    )
    none = changed(good, sdp_gap=[1, 300])
    yield Case("dual gap without nu", outcome_of(none), r"REFUSED: claims\.sdp_gap")


def basin_cases(example: Example) -> Iterator[Case]:
    """At rest and turned, spinning at the optimum with exponents of both signs, both at once."""
    good = axes()
    equal = stated(good, Fraction(1, 2**40), 10 + Fraction(1, 2**40))  # the level is 18
    best = [1, 0, 0, 0]
    for name, state, inside in (
        ("the optimum at rest", (best, [0, 0, 0, 0]), True),
        ("spin at the level", (best, [2, 0, 0, 0]), False),  # 28 - 10 4 / 4 = 18
        ("spin below the level", (best, [2**31 - 1, 0, 0, -30]), True),
        ("spin above the level", (best, [-(2**31) - 1, 0, 0, -30]), False),
        ("turned to the level", ([1, 1, 0, 0], [0, 0, 0, 0]), False),  # (28 + 8) / 2 = 18
        ("turned below the level", ([2**31 + 1, 2**31, 0, 0], [0, 0, 0, 0]), True),
        ("turned above the level", ([2**31 - 1, 2**31, 0, 0], [0, 0, 0, 0]), False),
        ("another equilibrium", ([0, 1, 0, 0], [0, 0, 0, 0]), False),
        ("no rotation", ([0, 0, 0, 0], [0, 0, 0, 0]), False),
    ):
        yield Case(f"basin: {name}", outcome_of(in_state(equal, *state)), said(inside=inside))
    finer = stated(good, Fraction(1, 2**400), 10 + Fraction(1, 2**400))  # than K's unit
    for name, velocity, inside in (("below", 2**31 - 1, True), ("above", -(2**31) - 1, False)):
        spinning = in_state(finer, best, [velocity, 0, 0, -30])
        yield Case(f"basin: fine, {name} the level", outcome_of(spinning), said(inside=inside))
    for name, parts in {
        "no state": {"basin": None},
        "no rotation given": {"basin": {"quaternion": None, "angular_velocity": [0, 0, 0, 0]}},
        "no velocity given": {"basin": {"quaternion": best, "angular_velocity": None}},
    }.items():
        claimed = {**changed(good, claims__basin=True), **parts}
        yield Case(f"basin: {name}", outcome_of(claimed), said(inside=False))
    unclaimed = {**good, "basin": {"quaternion": [0, 1, 0, 0], "angular_velocity": [1, 0, 0, 9**9]}}
    yield Case("basin: not claimed", outcome_of(unclaimed), "VERIFIED")
    denied = changed(unclaimed, claims__basin=False)
    yield Case("basin: claimed not to be", outcome_of(denied), "VERIFIED")
    pattern, source, target = oracle.PATTERNS["collinear source"]
    line = oracle.produce(source, target, pattern=pattern)
    yield Case(
        "basin: a line", outcome_of(in_state(line, line["pose"], [0] * 4)), said(inside=False)
    )
    yield from small_body_cases(good, best)
    yield from general_basin_cases(example)


def in_state(certificate: Certificate, quaternion: list[int], velocity: list[int]) -> Certificate:
    state = {"quaternion": quaternion, "angular_velocity": velocity}
    return {**changed(certificate, claims__basin=True), "basin": state}


def said(*, inside: bool) -> str:
    return "VERIFIED.*ends at the optimum" if inside else f"REFUSED: {BASIN}$"


def small_body_cases(good: Certificate, best: list[int]) -> Iterator[Case]:
    """J is 2^-60 times that of the octahedron, K the same: w about 2^31, whatever the exponent."""
    small = axes(np.array(AXES) * 2.0**-30, np.array(AXES) * 2.0**30)
    del good
    level = 18 + Fraction(1, 2**40)
    for axis, inertia in enumerate((10, 20, 26)):
        for exponent in (-40, -1, 0, 1, 12, 20):
            power = Fraction(4) ** (exponent - 30)

            def below(k: Fraction, inertia: int = inertia, power: Fraction = power) -> bool:
                return 28 - Fraction(inertia, 4) * int(k) ** 2 * power > level

            edge = int(threshold(below, Fraction(0), Fraction(2) ** (33 - exponent)))
            for k in (edge, edge + 1, -edge, -edge - 1):
                velocity = [k * (i == axis) for i in range(3)]
                certificate = in_state(small, best, [*velocity, exponent])
                answer = said(inside=below(Fraction(k)))
                yield Case(f"basin: spin {k} 2^{exponent}, {axis}", outcome_of(certificate), answer)


def general_basin_cases(example: Example) -> Iterator[Case]:
    mu = threshold(lambda x: x < example.gap / 2, Fraction(0), example.gap)
    delta = 2 * threshold(lambda x: not example.proves(x, mu), Fraction(0), example.gap)
    good, level = stated(example.certificate, delta, mu), example.v + delta - mu
    other = [example.q[1], -example.q[0], example.q[3], -example.q[2]]
    for name, turned, spun in (("spin", 0, 1), ("turn", 1, 0), ("both", 1, 1)):
        for exponent in (-25, 0, 9):
            w = [c * spun for c in (3, -2, 5)]

            def state(
                k: int, turned: int = turned, w: list[int] = w
            ) -> tuple[list[int], list[int]]:
                p = [2**40 * a + turned * k * b for a, b in zip(example.q, other, strict=True)]
                return p, [k * c for c in w]

            def below(k: Fraction, state: Any = state, exponent: int = exponent) -> bool:
                p, velocity = state(int(k))
                spin = form(example.J, velocity) / 4 * Fraction(4) ** exponent
                return form(example.K, p) / sum(c * c for c in p) - spin > level

            edge = int(threshold(below, Fraction(0), Fraction(2) ** 60))
            for k in (edge, edge + 1):
                p, velocity = state(k)
                certificate = in_state(good, p, [*velocity, exponent])
                answer = said(inside=below(Fraction(k)))
                yield Case(f"basin: {name} {k} 2^{exponent}", outcome_of(certificate), answer)


# --- The form and its limits ----------------------------------------------------------------------


def form_cases() -> Iterator[Case]:
    good = axes()
    text = oracle.dump(good)
    large = "REFUSED: the certificate is too large$"
    yield Case("bytes at most", outcome_of(text, FILE_MAX=len(text)), "VERIFIED")
    yield Case("a byte too many", outcome_of(text, FILE_MAX=len(text) - 1), large)
    used = sum(map(text.count, (b",", b"[", b"{")))
    for sign in (b",", b"[", b"{"):
        for more, answer in ((50_000 - used, "VERIFIED"), (50_001 - used, large)):
            filled = text.replace(b"the tests", sign * more)
            yield Case(f"{more} more {sign!r}", outcome_of(filled), answer)
    long = "REFUSED: an integer has more than 4300 digits$"
    for number, answer in (
        (b"9" * 4300, "VERIFIED"),
        (b"9" * 4301, long),
        (b"-" + b"9" * 4299, "VERIFIED"),
        (b"-" + b"9" * 4300, long),
    ):
        filled = text.replace(b'"the tests"', number)
        yield Case(f"{len(number)} digits", outcome_of(filled), answer)
    far = "REFUSED: an exponent is too large$"
    yield Case("greatest exponent", outcome_of(changed(good, gap=[1, 32768])), "VERIFIED")
    for gap in ([1, 32769], [1, -32769], [1, 10**9], [1, -(10**9)]):
        yield Case(f"exponent {gap[1]}", outcome_of(changed(good, gap=gap)), far)
    for exponent, answer in ((-32768, "VERIFIED"), (-32769, far), (32769, far)):
        state = in_state(good, [1, 0, 0, 0], [1, 0, 0, exponent])
        yield Case(f"angular velocity 2^{exponent}", outcome_of(state), answer)
    for name, broken in {
        "not UTF-8": text.replace(b"made", b"\xff"),
        "cut off": text[:-1],
        "not JSON": b"{'a': 1}",
        "NaN": text.replace(b'"the tests"', b"NaN"),
        "deep": b"[" * 40_000,
    }.items():
        answer = "REFUSED: the certificate is not JSON in UTF-8 of a sane depth$"
        yield Case(name, outcome_of(broken), answer)
    twice = text.replace(b'"made by"', b'"a": 1, "a"')
    yield Case("a key twice", outcome_of(twice), "REFUSED: a key appears twice$")
    yield from key_cases(good)
    yield from type_cases(good)


def key_cases(good: Certificate) -> Iterator[Case]:
    must = "REFUSED: {} must have exactly the keys {}$"
    keys = {
        "the certificate": re.escape(" ".join(sorted([*good, "radius?", "rotation_only?"]))),
        "claims": " ".join(sorted(good["claims"])),
        "optimality": "delta mu",
        "problem": "data digest n",
        "basin": "angular_velocity quaternion",
        "sdp": "nu",
    }
    full = changed(good, sdp={"nu": [29, 0]}, basin={"quaternion": [1, 0, 0, 0]})
    full["basin"]["angular_velocity"] = [0, 0, 0, 0]
    yield Case("all parts there", outcome_of(full), "VERIFIED")
    for name, expected in keys.items():
        part = full if name == "the certificate" else full[name]
        answer = must.format(name, expected)
        for key in part:
            less = {k: v for k, v in part.items() if k != key}
            if key == "kind":
                continue
            for other in (less, {**part, key + "s": None}, {**less, key + "s": part[key]}):
                certificate = other if name == "the certificate" else {**full, name: other}
                yield Case(f"keys {sorted(other)}", outcome_of(certificate), answer)
        if name != "the certificate":
            for value in (1, [], "text", *([] if name in {"basin", "sdp"} else [None])):
                yield Case(f"{name} {value}", outcome_of({**full, name: value}), answer)
    for value in ([], 1, None, "x", {}):
        certificate = oracle.dump(value)
        yield Case(
            f"a certificate {value}",
            outcome_of(certificate),
            must.format(*next(iter(keys.items()))),
        )
    unknown = "REFUSED: not a certreg-certificate/1 of a known kind$"
    for parts in (
        {"format": "certreg-certificate/2"},
        {"format": None},
        {"kind": "isotropics"},
        {"kind": ""},
        {"kind": None},
        {"kind": ["count"]},
        {"kind": {}},
        {"about": None},
        {"about": []},
    ):
        yield Case(f"with {parts}", outcome_of({**good, **parts}), unknown)


def type_cases(good: Certificate) -> Iterator[Case]:
    full = changed(good, sdp={"nu": [29, 0]}, basin={"quaternion": [1, 0, 0, 0]})
    full["basin"]["angular_velocity"] = [0, 0, 0, 0]
    full = changed(full, claims__basin=True, sdp_gap=[4, 0])
    yield Case("all claims there", outcome_of(full), "VERIFIED")
    scalars = {"n": 6, "unique": True, "data": "", "digest": "", "claims__basin": True}
    nulls = {"data", "claims__basin", "sdp_gap", "sin2_half_angle", "unstable"}
    nulls |= {"angular_velocity", "quaternion", "nu"}
    dyadics = ("delta", "mu", "gap", "sin2_half_angle", "nu", "sdp_gap")
    fours = ("pose", "quaternion", "angular_velocity")
    for name in (*scalars, *dyadics, *fours, "pattern", "unstable"):
        told = name.removeprefix("claims__")
        answer = f"REFUSED: {told} is of a wrong type$"
        right = type(scalars.get(name, []))
        for value in (1.5, {}, "x", [1], True, 1, *(() if name in nulls else (None,))):
            if type(value) is not right:
                yield Case(f"{name} {value}", outcome_of(changed(full, **{name: value})), answer)
        if name in nulls:
            refused = f"(?!REFUSED: ({told} is|a key|not a|the certificate must))"
            yield Case(f"{name} null", outcome_of(changed(full, **{name: None})), refused)
    for name in (*dyadics, *fours, "pattern", "unstable"):
        length = 2 if name in dyadics else 4
        answer = f"REFUSED: {name} is not a list of integers of the right length$"
        lengths = {length + 1, 5, 6} if name in {"pattern", "unstable"} else {0, 1, 3, 5}
        for other in sorted(lengths):
            ones = [1] * other
            yield Case(f"{name} {ones}", outcome_of(changed(full, **{name: ones})), answer)
        for entry in (True, 1.0, None, "1", [1]):
            value = [entry, *[1] * (length - 1)]
            yield Case(f"{name} {value}", outcome_of(changed(full, **{name: value})), answer)
            value = [*[1] * (length - 1), entry]
            yield Case(f"{name} {value}", outcome_of(changed(full, **{name: value})), answer)


# --- The points -----------------------------------------------------------------------------------


def flat(
    source: Any, target: Any, weights: Any = None, *, any_weight: bool = False
) -> SimpleNamespace:
    parts = [tuple(float(x) for x in np.ravel(cloud)) for cloud in (source, target)]
    given = None if weights is None else tuple(float(w) for w in weights)
    return SimpleNamespace(
        source=parts[0], target=parts[1], weights=given, model="", any_weight=any_weight
    )


def data_cases() -> Iterator[Case]:
    pattern, source, target = oracle.PATTERNS["one point"]
    one = oracle.produce(source, target, pattern=pattern)
    yield Case("n 1", outcome_of(one), "VERIFIED")
    out = "REFUSED: n is out of range$"
    for n, answer in (
        (0, out),
        (-1, out),
        (2**40, out),
        (2**40 - 1, "REFUSED: data is not of n points$"),
    ):
        yield Case(f"n {n}", outcome_of(changed(one, n=n)), answer)
    for n, answer in ((2**40, out), (2**40 - 1, "REFUSED: the certificate holds no points")):
        yield Case(f"n {n} without data", outcome_of(changed(one, n=n, data=None)), answer)
    good = axes()
    yield Case("points at most", outcome_of(good, INLINE_MAX=6), "VERIFIED")
    yield Case("a point too many", outcome_of(good, INLINE_MAX=5), "REFUSED: data is not of n p")
    limits = value_of(lambda checker: (checker.INLINE_MAX, checker.FILE_MAX))  # see `large_cases`
    yield Case("limits", limits, r"\(1000000, 100000000\)$")
    yield from base64_cases(good)
    yield from cloud_cases()
    yield from number_cases()
    yield from block_cases()


def base64_cases(good: Certificate) -> Iterator[Case]:
    content = base64.b64decode(good["problem"]["data"])
    other = "REFUSED: data is not canonical, or not of n points$"
    for name, changes in {
        "another prefix": b"certreg-problem/2\0" + content[18:],
        "another n within": content[:18] + struct.pack("<Q", 7) + content[26:],
        "a byte too few": content[:-1],
        "a byte too many": content + b"\0",
    }.items():
        fits = len(base64.b64encode(changes)) == len(good["problem"]["data"])
        answer = other if fits else "REFUSED: data is not of n points$"
        yield Case(f"data: {name}", outcome_of(oracle.with_problem(good, changes)), answer)
    data = good["problem"]["data"]
    for changes, answer in (
        (data + "=", "REFUSED: data is not of n points$"),
        (data[:-1], "REFUSED: data is not of n points$"),
        ("*" + data[1:], "REFUSED: data is not base64$"),
        (data[:8] + "\n" + data[9:], "REFUSED: data is not base64$"),
    ):
        yield Case(f"data {changes[-9:]}", outcome_of(changed(good, data=changes)), answer)
    for n in (6, 7, 8):  # 362, 418, 474 bytes: 2, 1, 0 over a multiple of three
        source = np.arange(3.0 * n).reshape(n, 3) ** 2
        certificate = oracle.produce(source, source)
        data = certificate["problem"]["data"]
        yield Case(f"{n} points", outcome_of(certificate), "VERIFIED")
        padded = data.rstrip("=")
        if padded != data:  # the bits left over set
            last = chr(ord(padded[-1]) + 1)
            spoilt = padded[:-1] + last + data[len(padded) :]
            yield Case(f"bits left of {n}", outcome_of(changed(certificate, data=spoilt)), other)
    digest = good["problem"]["digest"]
    for wrong in (digest.upper(), digest[:-1], "0" * 64, ""):
        answer = NOT_THEIRS
        yield Case(f"digest {wrong}", outcome_of(changed(good, digest=wrong)), answer)


def cloud_cases() -> Iterator[Case]:
    source, target, weights = oracle.random_problem(seed=3, n=6)
    uneven, even = oracle.produce(source, target, weights), oracle.produce(source, target)
    number = "REFUSED: the certificate is about another number of points or weights$"
    points = "REFUSED: the certificate is about other points$"
    weight = "REFUSED: the certified weights are unequal: give --weights FILE$"
    theirs = NOT_THEIRS
    moved = np.nextafter(source, 9)
    shifted = np.array(target)
    shifted[5, 2] = np.nextafter(shifted[5, 2], 9)
    first, last = np.array(weights), np.array(weights)
    first[0] = np.nextafter(first[0], 9)
    last[5] = np.nextafter(last[5], 9)
    for name, certificate, clouds, answer, lone in (
        ("same", uneven, flat(source, target, weights), "VERIFIED", "VERIFIED"),
        ("same, even", even, flat(source, target), "VERIFIED", "VERIFIED"),
        ("ones", even, flat(source, target, [1] * 6), "VERIFIED", "VERIFIED"),
        ("weights untold", uneven, flat(source, target), weight, theirs),
        ("moved", uneven, flat(moved, target, weights), points, theirs),
        ("last number", uneven, flat(source, shifted, weights), points, theirs),
        ("first weight", uneven, flat(source, target, first), weight, theirs),
        ("last weight", uneven, flat(source, target, last), weight, theirs),
        ("exchanged", uneven, flat(target, source, weights), points, theirs),
        ("fewer source", uneven, flat(source[1:], target, weights), number, number),
        ("fewer target", uneven, flat(source, target[1:], weights), number, number),
        ("fewer weights", uneven, flat(source, target, weights[1:]), number, number),
        ("no weights", uneven, flat(source, target, []), number, number),
    ):
        yield Case(f"clouds: {name}", outcome_of(certificate, clouds), answer)
        without = changed(certificate, data=None)
        yield Case(f"clouds alone: {name}", outcome_of(without, clouds), lone)
    halves = oracle.produce(source, target, [0.5] * 6)
    other = outcome_of(changed(even, digest="0" * 64), flat(source, target))
    yield Case("clouds: another digest", other, theirs)
    any_of_them = flat(source, target, any_weight=True)
    yield Case("clouds: any weight", outcome_of(halves, any_of_them), "VERIFIED")
    yield Case("clouds: any weight, uneven", outcome_of(uneven, any_of_them), weight)
    yield from weight_cases(source, target)
    yield Case("even", outcome_of(even), "VERIFIED\nData: n = 6 pairs, all of one weight")
    yield Case("uneven", outcome_of(uneven), "VERIFIED\nData: n = 6 pairs, NOT all of one weight")
    answer = "REFUSED: the certificate holds no points: give SOURCE and TARGET$"
    yield Case("no points", outcome_of(changed(even, data=None)), answer)
    zero = np.array(AXES) + 0.0
    negative = np.where(zero == 0, -0.0, zero)
    yield Case("clouds with -0.0", outcome_of(axes(), flat(negative, negative)), "VERIFIED")


def weight_cases(source: Any, target: Any) -> Iterator[Case]:
    """Clouds without weights, beside certificates of one weight: 1 alone will do."""
    told = "REFUSED: the certified weight is {!r}, not 1: give {}"
    given, any_of_them = flat(source, target), flat(source, target, any_weight=True)
    for sigma in (0.01, 0.05, 2.5, 1e-6, 123456.0, 0.123456, 3.0, 7e-100, 1e100):
        certified = float(1 / Fraction(sigma) ** 2)
        certificate = of_weight(certified, source, target)
        answer = re.escape(told.format(certified, f"--sigma {sigma!r}")) + "$"
        yield Case(f"clouds: sigma {sigma}", outcome_of(certificate, given), answer)
        other = flat(source, target, [certified] * 5 + [math.nextafter(certified, 0)])
        answer = answer.replace("not\\ 1", "not\\ as\\ given")
        yield Case(f"clouds: not sigma {sigma}", outcome_of(certificate, other), answer)
    for certified in (
        *(math.nextafter(1, 0), math.nextafter(1, 2), math.nextafter(1e4, 0), 1 / 3),
        *(2.0**-1000, 1e-300, 1e300, 5e-324, 1.7e308, 0.0, -1.0, math.nan, math.inf),
    ):
        certificate = of_weight(certified, source, target)
        answer = re.escape(told.format(certified, "--any-weight")) + "$"
        yield Case(f"clouds: weight {certified}", outcome_of(certificate, given), answer)
        same = outcome_of(certificate, any_of_them)
        yield Case(f"clouds: any weight {certified}", same, "REFUSED: (?!the certified weight)")


def of_weight(weight: float, source: Any, target: Any) -> Certificate:
    """A certificate of these points that all have the weight, and of another pose."""
    return oracle.with_problem(axes(), oracle.problem_bytes(source, target, [weight] * 6))


def number_cases() -> Iterator[Case]:
    good = axes()
    numbers = np.frombuffer(base64.b64decode(good["problem"]["data"])[26:], "<f8")
    for place in (0, 17, 18, 35, 36, 41):
        for value, words in (
            (np.nan, "not finite"),
            (np.inf, "not finite"),
            (-np.inf, "not finite"),
            (-0.0, "-0.0, which is not canonical"),
            *(((-5e-324, "negative"), (-1.0, "negative")) if place > 35 else ()),
        ):
            spoilt = numbers.copy()
            spoilt[place] = value
            content = oracle.PREFIX + struct.pack("<Q", 6) + spoilt.astype("<f8").tobytes()
            certificate = oracle.with_problem(good, content)
            yield Case(f"{value} at {place}", outcome_of(certificate), f"REFUSED: .*{words}")
    pattern, source, target = oracle.PATTERNS["one point"]
    for least in (5e-324, 2.0**-1022, 1.7e308):
        certificate = oracle.produce(source, target, [least], pattern=pattern)
        yield Case(f"the weight {least}", outcome_of(certificate), "VERIFIED")
    massless = oracle.with_problem(good, oracle.problem_bytes(AXES, AXES, [0] * 6))
    yield Case("no weight", outcome_of(massless), "REFUSED: no weight is positive$")
    for a, b, c in ((1e-100, 1e-100, 1e-50), (1e90, 1e-90, 1e10), (2.0**-1000, 1, 2.0**-1000)):
        source, target, weights = oracle.random_problem(seed=5, n=5)
        certificate = oracle.produce(source * a, target * b, weights * c)
        yield Case(f"scales {a} {b} {c}", outcome_of(certificate), "VERIFIED")


def block_cases() -> Iterator[Case]:
    """Moments of two blocks; the points of the second have weights and places of their own."""
    random = np.random.default_rng(9)
    for n, scale in ((1, 1.0), (8192, 1.0), (8193, 2.0**-4), (8193, 2.0**-8)):
        source, target = random.integers(-99, 99, (2, n, 3)) * 2.0 ** -np.arange(n // 8192 + 1)[-1]
        source[8192:] *= scale  # over another power of two than the first block
        weights = random.integers(1, 9, n)
        weights[[0, min(n, 8192) - 1]], weights[8192:] = 99, 98  # alike at both ends of a block
        content = oracle.problem_bytes(source, target, weights)[26:]
        a = np.column_stack([np.ones(n), source, target])
        table = (a[:, :4] * weights[:, None]).T @ a  # exact: small numbers

        def agrees(checker: Any, content: bytes = content, table: Any = table) -> bool:
            m, e = checker.moments(content, len(content) // 56)
            return all(
                m[i][j] * Fraction(2) ** e == Fraction(table[i, j])
                for i in range(4)
                for j in range(i, 7)
            )

        yield Case(f"moments of {n}, the last times {scale:g}", value_of(agrees), "True$")
    yield from _apart_cases()


def _apart_cases() -> Iterator[Case]:
    """Moments of numbers far apart: all of them, those of one cloud, and the weights alone."""
    random = np.random.default_rng(3)
    ones, powers = np.ones((3, 5)), 2.0 ** random.integers(-300, 300, (3, 5))
    large = 2.0 ** np.array([100, 200, 300, 300, 200])
    for name, scales in {
        "all": powers,
        "sources": [powers[0], *ones[1:]],
        "targets": [ones[0], powers[1], ones[2]],
        "weights": [*ones[:2], powers[2]],
        "all, none small": [large, large, ones[2]],
        "all, of one weight": powers,
        "none, but tiny beside zeros": [2.0**-300 * ones[0], *ones[1:]],
    }.items():
        source, target = (random.normal(size=(5, 3)) * scales[k][:, None] for k in (0, 1))
        source[0, 1] = 0.0
        weights = random.uniform(1, 2, 5) * scales[2]
        weights = np.full(5, 3.0) if "one weight" in name else weights
        content = oracle.problem_bytes(source, target, weights)[26:]
        rows = [
            [Fraction(float(x)) for x in (1, *a, *b)] for a, b in zip(source, target, strict=True)
        ]
        table = [
            [
                sum(
                    Fraction(float(w)) * row[i] * row[j]
                    for w, row in zip(weights, rows, strict=True)
                )
                for j in range(7)
            ]
            for i in range(7)
        ]

        def agrees(checker: Any, content: bytes = content, table: Any = table) -> bool:
            m, e = checker.moments(content, 5)
            return all(
                m[i][j] * Fraction(2) ** e == table[i][j]
                for i in range(7)
                for j in range(i, 7 if i < 4 else i + 1)  # of products of y, the squares
            )

        yield Case(f"moments far apart, {name}", value_of(agrees), "True$")


# --- Equilibrium sets, counts, words, the command -------------------------------------------------


def pattern_cases() -> Iterator[Case]:
    kinds = ("", "one rotation", "a circle", "a projective plane", "all rotations")
    for name, (pattern, source, target) in oracle.PATTERNS.items():
        certificate = oracle.produce(source, target, pattern=pattern)
        solid = certificate["claims"]["unstable"] is not None
        told = ", ".join(kinds[k] for k in pattern)
        unique = (
            "is unique"
            if pattern[0] == 1
            else f"is NOT unique: the optima form {kinds[pattern[0]]}"
        )
        counts = ", ".join(str(sum(pattern[:k])) for k in range(len(pattern)))
        words = "unstable directions" if solid else "directions of descent"
        answer = rf"VERIFIED.*optimum {unique}.*: {told}; {words}: {counts}\."
        yield Case(name, outcome_of(certificate), answer)
        claimed = changed(certificate, unique=True)
        refusal = r"REFUSED: claims\.unique is wrong: it is not unique$"
        yield Case(f"{name}, unique", outcome_of(claimed), "VERI" if pattern[0] == 1 else refusal)
        indices = [sum(pattern[:k]) for k in range(len(pattern))]
        claimed = changed(certificate, unstable=indices)
        refusal = r"REFUSED: claims\.unstable is wrong or unproved: proved is None$"
        yield Case(f"{name}, unstable", outcome_of(claimed), "VERIFIED" if solid else refusal)
        wrong = changed(certificate, pattern=[4 if pattern != [4] else 1])
        yield Case(f"{name}, other", outcome_of(wrong), r"REFUSED: claims\.pattern is wrong")
        for order in (sorted(pattern), sorted(pattern, reverse=True)):
            moved = changed(certificate, pattern=order, unique=False)
            answer = "VERIFIED" if order == pattern else r"REFUSED: claims\.pattern is wrong"
            yield Case(f"{name}, as {order}", outcome_of(moved), answer)
    massless = oracle.produce(
        [[1, 0, 0], [2, 0, 0], [3, 0, 0], [0, 1, 0]], [[0, 1, 2]] * 4, [1, 1, 1, 0], pattern=[4]
    )
    yield Case("beside a line, of weight 0", outcome_of(massless), "VERIFIED.*are collinear")
    for d in (
        (3, 2, 1),
        (3, 2, -1),
        (2, 2, 1),
        (2, 2, -1),
        (3, 1, 1),
        (3, 1, -1),
        (5, 4, 4),
        (5, 5, 4),
        (5, 5, -4),
    ):
        C = oracle_rotation((1, 2, -1, 3)) @ np.diag(d) @ oracle_rotation((5, -1, 2, 0)).T
        a, b, c = d
        levels = sorted([a + b + c, a - b - c, b - a - c, c - a - b], reverse=True)
        expected = [levels.count(x) for x in sorted(set(levels), reverse=True)]
        for factor in (1, 3, 2**70):
            matrix = [[int(x) * factor for x in row] for row in C.tolist()]
            yield Case(
                f"multiplicities of {d} {factor}",
                value_of(lambda checker, matrix=matrix: checker.multiplicities(matrix)),
                re.escape(repr(expected)) + "$",
            )


def oracle_rotation(q: tuple[int, ...]) -> Any:
    """|q|^2 R(q), of Python's integers."""
    w, x, y, z = q
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    return np.array(rows, dtype=object)


def counted(
    certificate: Certificate, chart: list[int], modulus: int, at_most: int = 4
) -> Certificate:
    kept = {name: certificate[name] for name in ("about", "format", "problem")}
    proof = {"chart": chart, "modulus": modulus}
    return {**kept, "kind": "count", "claims": {"at_most": at_most}, "proof": proof}


def count_cases() -> Iterator[Case]:
    good, first, prime = axes(), [1, 2, 4, 8], 2**61 - 1
    proof = "REFUSED: proof does not show the quadratics independent$"
    out = r"REFUSED: proof\.modulus is out of range$"
    yield Case("count", outcome_of(counted(good, first, prime)), "VERIFIED.*At most four rotations")
    light = outcome_of(counted(axes(weights=[0.1] * 6), first, prime))
    yield Case("count: weights", light, r"VERIFIED.*\nSum of weights: 0\.600000000001, rounded up")
    for at_most in (-1, 0, 1, 2, 3, 4, 5, 10**9):
        answer = (
            "VERIFIED" if at_most >= 4 else r"REFUSED: claims\.at_most is below the proved bound 4$"
        )
        yield Case(f"at most {at_most}", outcome_of(counted(good, first, prime, at_most)), answer)
    for modulus, answer in (
        (-7, out),
        (0, out),
        (1, out),
        (2, proof),
        (7, "VERIFIED"),
        (2**64 - 59, "VERIFIED"),  # the greatest prime below 2^64
        (2**64 - 1, proof),  # 3 5 17 257 641 65537 6700417
        (2**64, out),
        (2**64 + 13, out),
    ):
        yield Case(f"modulus {modulus}", outcome_of(counted(good, first, modulus)), answer)
    for chart in ([0, 0, 0, 0], [0, 0, 0, prime]):
        yield Case(f"chart {chart}", outcome_of(counted(good, chart, prime)), proof)
    turned = oracle.produce(AXES, -np.array(AXES), pattern=[1, 1, 1, 1])
    yield Case(
        "a half turn, of which w = 0", outcome_of(counted(turned, [1, 0, 0, 0], prime)), proof
    )
    yield Case("a half turn, seen", outcome_of(counted(turned, first, prime)), "VERIFIED")
    best = (1, 2, -1, 3)  # the others: (-2, 1, 3, 1), (1, -3, 1, 2), (-3, -1, -2, 1)
    rotated = oracle.produce(AXES, np.array(AXES) @ oracle_rotation(best).T.astype(float))
    for chart, answer in (
        ([1, 0, 0, 0], "VERIFIED"),
        ([0, 0, 0, -5], "VERIFIED"),
        ([3, 0, 0, -1], proof),
        ([2, -1, 0, 0], proof),
        ([1, 2, 0, 0], proof),
        ([3, 1, 0, 0], proof),
        ([3, 1, 1, 0], "VERIFIED"),
    ):
        yield Case(f"rotated axes, {chart}", outcome_of(counted(rotated, chart, prime)), answer)
    yield from torque_cases()
    generic = oracle.produce(*oracle.random_problem(seed=3, n=5))
    for chart in ([1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1], [3, -1, 4, 1]):
        yield Case(f"generic {chart}", outcome_of(counted(generic, chart, prime)), "VERIFIED")
    for name, (pattern, source, target) in oracle.PATTERNS.items():
        content = oracle.produce(source, target, pattern=pattern)
        answer = "VERIFIED" if pattern == [1, 1, 1, 1] else proof
        yield Case(f"count: {name}", outcome_of(counted(content, [1, 5, 7, 11], prime)), answer)
    massless = oracle.with_problem(good, oracle.problem_bytes(AXES, AXES, [0] * 6))
    none = "REFUSED: no weight is positive$"
    yield Case("count: no weight", outcome_of(counted(massless, first, prime)), none)
    yield from count_form_cases(counted(good, first, prime))


def torque_cases() -> Iterator[Case]:
    """The coefficients of |q|^2 R(q), and torques of matrices that are no rotations."""
    for q in ((1, 2, -1, 3), (5, -1, 2, 0), (0, 3, 0, -7)):

        def rotates(checker: Any, q: tuple[int, ...] = q) -> bool:
            terms = (
                q[i] * q[j] * np.array(checker.rotation_coefficient(i, j), dtype=object)
                for i in range(4)
                for j in range(i, 4)
            )
            return bool((sum(terms) == oracle_rotation(q)).all())

        yield Case(f"coefficients of R{q}", value_of(rotates), "True$")
    A, C = [[1, 2, 3], [4, 5, 6], [7, 8, 10]], [[2, 0, 1], [1, 3, -1], [0, 5, 4]]
    X, Y = np.array(A), np.array(C)
    inner, outer = X.T @ Y - Y.T @ X, X @ Y.T - Y @ X.T
    expected = [int(M[i][j]) for M in (inner, outer) for i, j in ((0, 1), (0, 2), (1, 2))]
    answer = re.escape(repr(expected)) + "$"
    yield Case("torques", value_of(lambda checker: checker.torques(A, C)), answer)


def count_form_cases(good: Certificate) -> Iterator[Case]:
    must = "REFUSED: {} must have exactly the keys {}$"
    for name, keys in (
        ("the certificate", "about claims format kind problem proof"),
        ("claims", "at_most"),
        ("problem", "data digest n"),
        ("proof", "chart modulus"),
    ):
        part = good if name == "the certificate" else good[name]
        for key in part:
            less = {k: v for k, v in part.items() if k != key}
            for other in (less, {**part, "more": None}):
                certificate = other if part is good else {**good, name: other}
                if "kind" in certificate:
                    yield Case(
                        f"count: {sorted(other)}", outcome_of(certificate), must.format(name, keys)
                    )
        if part is not good:
            yield Case(
                f"count: {name} null", outcome_of({**good, name: None}), must.format(name, keys)
            )
    for name in ("at_most", "modulus", "chart", "n", "digest"):
        for value in (None, True, 1.5, {}, *(() if name == "digest" else ("x",))):
            answer = f"REFUSED: {name} is of a wrong type$"
            yield Case(f"count: {name} {value}", outcome_of(changed(good, **{name: value})), answer)
    for chart in ([], [1, 0, 0], [1, 0, 0, 0, 0], [True, 0, 0, 0], [1.0, 0, 0, 0]):
        answer = "REFUSED: chart is not a list of integers of the right length$"
        yield Case(f"count: chart {chart}", outcome_of(changed(good, chart=chart)), answer)
    yield Case("count: about null", outcome_of({**good, "about": None}), "REFUSED: not a certreg")
    yield Case("count: a format", outcome_of({**good, "format": "x"}), "REFUSED: not a certreg")


def word_cases() -> Iterator[Case]:
    good = axes()
    for delta, mu, gap, degrees in (  # by hand: 2 delta, and 2 atan sqrt(delta/(mu - delta)) or so
        (Fraction(1), Fraction(2), "2.0e+0", r"1\.2e\+2"),  # 360/pi = 114.6
        (Fraction(1), Fraction(17), "2.0e+0", r"2\.9e\+1"),  # 114.6/4 = 28.65
        (Fraction(1, 2**40), Fraction(16), "1.9e-12", r"2\.8e-5"),  # 114.6/2^22 = 2.732e-5
    ):
        number = re.escape(gap)
        answer = rf"VERIFIED.*by less than {number} .*within {degrees} degrees of R"
        yield Case(f"words of {delta} {mu}", outcome_of(stated(good, delta, mu)), answer)
    yield from worth_cases(good)
    square = Case(
        "quaternion",
        outcome_of(changed(good, pose=[2**50, 3, 0, 0])),
        r".*\(1\.000000000000, 0\.000000000000, ",
    )
    yield square
    tilted = stated(changed(good, pose=[4, 0, 3, 0]), Fraction(100), Fraction(0))
    answer = (
        r"VERIFIED.*\(0\.800000000000, 0\.000000000000, 0\.600000000000, 0\.000000000000\), rounded"
    )
    yield Case("unit quaternion", outcome_of(tilted), answer)
    dual = changed(good, sdp={"nu": [57, -1]}, sdp_gap=[1, 0])
    yield Case(
        "words of the dual", outcome_of(dual), r"VERIFIED.*dual bounds that gap by 1\.0e\+0\."
    )
    dual = changed(good, sdp={"nu": [57, -1]}, sdp_gap=[33, -5])  # 1.03125
    yield Case("rounded up", outcome_of(dual), r"VERIFIED.*dual bounds that gap by 1\.1e\+0\.")
    long = changed(good, pose=[2, 0, 0, 0], sdp={"nu": [57, -1]}, sdp_gap=[31, -5])
    yield Case("a dual gap, |q| = 2", outcome_of(long), r"REFUSED: claims\.sdp_gap is below")
    nothing = stated(changed(good, sdp={"nu": [0, 0]}), Fraction(128), Fraction(64))
    yield Case("nu = 0 beside a large mu", outcome_of(nothing), r"REFUSED: sdp\.nu bounds nothing")
    tiny = stated(good, Fraction(1, 2**300), Fraction(16))  # 2^-299/79.196 = 1.2397e-92
    words = r"VERIFIED.*translation: 0; both .*less than 1\.3e-92 of the range"
    yield Case("delta 2^-300", outcome_of(tiny), words)


def worth_cases(good: Certificate) -> Iterator[Case]:
    """What the certificate is worth: the octahedron's F^2 is 28^2 + 8^2 + 12^2 + 24^2 = 1568."""
    twice = root(Fraction(4 * 1568))  # 2 F = 79.196 < 104, the range of energies
    number = r"8\.0e\+1"
    for name, gap, answer in (
        ("below", twice * (1 - NEAR), r"VERIFIED.*This gap is less than 1\.0e\+0 of the range"),
        ("above", twice * (1 + NEAR), r"VERIFIED.*This gap bounds nothing: the range of energies"),
    ):
        yield Case(f"a gap {name} 2 F", outcome_of(loosely(good, gap)), answer)
        bounded = changed(good, sdp={"nu": [57, -1]}, sdp_gap=dyadic(gap))
        end = r"\." if name == "below" else r": nothing\."
        words = rf"VERIFIED.*The relaxation's dual bounds that gap by {number}{end}"
        yield Case(f"a dual gap {name} 2 F", outcome_of(bounded), words)
    void = r"VERIFIED.*less than {} .*bounds nothing.*No angle is bounded.*unique"
    for exponent, printed in ((32768, r"2\.9e\+9864"), (8, r"5\.2e\+2")):
        vacuous = changed(loosely(good, Fraction(1)), delta=[1, exponent], gap=[2, exponent])
        yield Case(f"delta 2^{exponent}", outcome_of(vacuous), void.format(printed))
    for delta, mu, bounded in (  # s/(1 - s) against (pi/2)^2 = 2.4674011
        (Fraction(24674010), Fraction(34674010), True),
        (Fraction(24674012), Fraction(34674012), False),
        (Fraction(2), Fraction(2), False),
        (Fraction(3), Fraction(2), False),
    ):
        scaled = stated(good, delta / 2**24, mu / 2**24)
        angle = r"within 1\.8e\+2 degrees of R" if bounded else "No angle is bounded"
        yield Case(f"words of {delta} {mu}", outcome_of(scaled), f"VERIFIED.*{angle}")
    pattern, source, target = oracle.PATTERNS["antipodes"]
    everywhere = oracle.produce(source, target, pattern=pattern)
    yield Case("range 0", outcome_of(everywhere), r"VERIFIED.*range of energies is 0: every rot")
    pattern, source, target = oracle.PATTERNS["mirrored"]  # a residual of 2, twice
    mirrored = oracle.produce(source, target, pattern=pattern)
    words = r"translation: 8; both .*the minimum is at least 7\.99999999999;"
    yield Case("energy 8", outcome_of(mirrored), "VERIFIED.*" + words)
    yield from tiny_weight_cases()
    yield from number_of_worth_cases()
    yield from limit_cases(good, everywhere)


def loosely(certificate: Certificate, gap: Fraction) -> Certificate:
    """With this gap, without an angle."""
    loose = changed(certificate, mu=[0, 0], sin2_half_angle=None, gap=dyadic(gap))
    return changed(loose, delta=dyadic(gap / 2))


def tiny_weight_cases() -> Iterator[Case]:
    """Weights of 2^-1000, a pose half a turn off: the gap is tiny and bounds nothing."""
    weights = [2.0**-1000] * 6
    tiny = oracle.with_problem(axes(), oracle.problem_bytes(AXES, AXES, weights))
    tiny = loosely(changed(tiny, pose=[0, 0, 0, 1]), Fraction(1, 2**990))
    words = r"Sum of weights: 5\.59[0-9]*e-301; objective at R, best translation: 9\.[0-9]*e-300;"
    rest = r".*less than 9\.6e-299 .*the minimum is at least 0; sqrt\S* .* is below 1\.4e\+1\."
    nothing = r".*This gap bounds nothing: .*No angle is bounded: nothing is proved"
    yield Case("weights 2^-1000", outcome_of(tiny), "VERIFIED.*" + words + rest + nothing)
    beside = outcome_of(tiny, flat(AXES, AXES))
    refusal = r"REFUSED: the certified weight is 9\.33[0-9]*e-302, not 1: give --any-weight$"
    yield Case("weights 2^-1000 beside clouds", beside, refusal)


def number_of_worth_cases() -> Iterator[Case]:
    """The numbers, held against sums over the points; the bounds are sharp to 18 digits."""
    long = 2.0 ** np.array([-400, *[0] * 6])[:, None]  # of one point: K has 900 bits
    scales = {"1": 1.0, "2^300": 2.0**300, "2^-400 of one": long, "1, weights near 1": 1.0}
    for name, scale in scales.items():
        source, target, weights = oracle.random_problem(seed=2, n=7, noise=0.3)
        source = source * scale
        if "weights" in name:  # whose sum is 8, a power of two, while their last bits are 1
            weights = np.array([*[1 - 2.0**-52, 1 + 2.0**-52] * 3, 2.0])
        certificate = oracle.produce(source, target, weights)
        w = [Fraction(float(c)) for c in weights]
        energy = energy_of(certificate["pose"], source, target, w)
        K = oracle.rotation_form(oracle.exact_moments(source, target, weights)[1])
        square = sum(entry**2 for row in K for entry in row)
        (d, e), (m, f) = (certificate["optimality"][name] for name in ("delta", "mu"))
        delta, mu = d * Fraction(2) ** e, m * Fraction(2) ** f
        certificate["claims"]["gap"] = [d, e + 3]  # weaker than what is proved
        exact = (sum(w), energy, max(energy - 2 * delta, Fraction(0)), 2 * delta)
        squares = (2 * delta / sum(w), delta**2 / square, 4 * delta / (mu - delta))

        def agrees(
            checker: Any,
            content: bytes = oracle.dump(certificate),
            exact: Any = exact,
            squares: Any = squares,
        ) -> bool:
            worth = checker.check(content).worth
            found = (worth.weight, worth.objective, worth.minimum, worth.gap)
            roots = (worth.length, worth.share, worth.angle)
            sharp = 1 + Fraction(1, 10**18)
            near = (b < a**2 < b * sharp for a, b in zip(roots, squares, strict=True))
            return found == exact and all(near)

        yield Case(f"worth at scale {name}", value_of(agrees), "True$")


def energy_of(q: list[int], source: Any, target: Any, weights: list[Fraction]) -> Fraction:
    """The objective at R(q), best translation, summed over the points."""
    square = sum(c * c for c in q)
    R = [[Fraction(int(k), square) for k in row] for row in oracle_rotation(tuple(q)).tolist()]
    pairs = list(zip(source.tolist(), target.tolist(), strict=True))
    left = [
        [Fraction(y[k]) - sum(R[k][j] * Fraction(x[j]) for j in range(3)) for k in range(3)]
        for x, y in pairs
    ]
    zero = Fraction(0)
    mean = [sum((w * row[k] for w, row in zip(weights, left, strict=True)), zero) for k in range(3)]
    total = sum(weights, zero)
    return sum(
        (
            w * (a - b / total) ** 2
            for w, row in zip(weights, left, strict=True)
            for a, b in zip(row, mean, strict=True)
        ),
        Fraction(0),
    )


def radius_cases() -> Iterator[Case]:
    """How far points may move. K = diag(28, 8, ...): apart by 20; M = 6, both spreads are 28.

    An angle of 60 degrees, s = 1/2, and mu - delta = 10: 10 (sin 60 - 2^-19 / sqrt(10)) is left,
    sqrt(168) of it for each cloud, and 6 more for the product.
    """
    good = stated(axes(), Fraction(1, 2**40), Fraction(10) + Fraction(1, 2**40))
    room = 10 * (root(Fraction(3, 4)) - root(4 * Fraction(1, 2**40) / 10))
    lever = root(Fraction(168))
    target, both = room / lever, (root(lever**2 + 6 * room) - lever) / 6
    less, more = 1 - NEAR, 1 + NEAR

    def moved(**parts: Fraction | None) -> Certificate:
        known = {"target": less * target, "both": less * both, "separation": 20 * (1 - NEAR / 16)}
        known |= {"sin_half_angle": Fraction(1, 2), **parts}
        short = {k: None if v is None else upward(v * (1 - NEAR / 64)) for k, v in known.items()}
        return {**good, "radius": short}

    ten = Fraction(10)
    for name, value in (("target", target), ("both", both)):
        yield Case(
            f"radius {name}, inside", outcome_of(moved(**{name: less**3 * value})), "VERIFIED"
        )
        answer = "REFUSED: radius is larger than what is proved$"
        yield Case(f"radius {name}, outside", outcome_of(moved(**{name: more * value})), answer)
    refused = "REFUSED: radius.separation is not proved$"
    for apart, answer in ((less * 20, "VERIFIED"), (more * 20, refused), (-ten, refused)):
        small = moved(separation=apart, target=target / 9, both=both / 9)
        for length in (1, 3):
            longer = outcome_of({**small, "pose": [length, 0, 0, 0]})
            yield Case(f"separation {float(apart)}, |q| = {length}", longer, answer)
    wide = moved(separation=ten, target=less**3 * target / 2, both=both / 9)
    yield Case("half the separation, inside", outcome_of(wide), "VERIFIED")
    wide = moved(separation=ten, target=more * target / 2, both=both / 9)
    too_large = "REFUSED: radius is larger than what is proved$"
    yield Case("half the separation, outside", outcome_of(wide), too_large)
    none = "REFUSED: radius is not of an angle up to 90 degrees, or not positive$"
    least = {"target": Fraction(1, 2**30), "both": Fraction(1, 2**30)}
    half = root(Fraction(1, 2))
    for parts, answer in (
        ({**least, "sin_half_angle": half}, "VERIFIED"),
        ({**least, "sin_half_angle": half * more}, none),
        ({"target": Fraction(0)}, none),
        ({"target": -target}, none),
        ({"both": Fraction(0)}, none),
        ({"both": -both}, none),
        ({"sin_half_angle": Fraction(0)}, none),
        ({"sin_half_angle": Fraction(-1, 2)}, none),
        ({"target": None}, none),
        ({"both": None}, none),
        ({"sin_half_angle": None}, none),
        ({"separation": None}, refused),
        ({**dict.fromkeys(("target", "both", "sin_half_angle"))}, "VERIFIED"),
    ):
        yield Case(f"radius {parts}", outcome_of(moved(**parts)), answer)
    yield Case("radius null", outcome_of({**good, "radius": None}), "VERIFIED")
    yield from _radius_words(moved(), target, both)
    for sizes in ((2**20, 1), (1, 2**20), (3, 5)):  # zeros at the end, which the checker takes out
        source, off = ([[k * c for c in row] for row in AXES] for k in sizes)
        scaled = axes(source, off)
        scaled |= {"radius": moved()["radius"]}
        size = Fraction(sizes[0] * sizes[1])
        scaled = stated(scaled, size / 2**40, 10 * size + size / 2**40)
        apart = 20 * (1 - NEAR / 16) * size
        for factor, answer in ((less**3, "VERIFIED"), (more, too_large)):
            scaled["radius"] = {
                **moved(separation=apart, target=factor * target * sizes[1])["radius"],
                "both": [1, -60],
            }
            yield Case(f"radius of {sizes}: {answer}", outcome_of(scaled), answer)
    # Weights that are no integers, and a delta finer than the units of all sums.
    for w, delta in ((Fraction(1, 4), Fraction(1, 2**40)), (Fraction(1), Fraction(1, 2**200))):
        short = stated(axes(weights=[float(w)] * len(AXES)), w * delta, w * (10 + delta))
        most = 10 * (root(Fraction(3, 4)) - root(4 * delta / 10)) / lever
        for factor, answer in ((less**3, "VERIFIED"), (more, too_large)):
            radius = moved(separation=20 * (1 - NEAR / 16) * w, target=factor * most)["radius"]
            short["radius"] = {**radius, "both": [1, -60]}
            name = f"radius of weight {w}, delta {float(delta):.0e}: {answer}"
            yield Case(name, outcome_of(short), answer)
    loose = stated(axes(), Fraction(10), Fraction(10))
    unsure = {**loose, "radius": moved(**least)["radius"]}
    yield Case("radius without an angle", outcome_of(unsure), refused)


def _radius_words(certificate: Certificate, target: Fraction, both: Fraction) -> Iterator[Case]:
    one, other = (f"{math.floor(float(r) * 1000) / 1000:g}" for r in (target, both))
    yield Case(
        "radius in words",
        outcome_of(certificate),
        f"VERIFIED\n.*\nIf every target point is off by less than {re.escape(one)}, every optimum "
        rf"is within 60\.\d+ degrees of R\.\nSo it is if every point of both clouds is off by less "
        rf"than {re.escape(other)}\. That is sufficient, not necessary; weights and matrices stay\."
        "\nNot proved",
    )


def limit_cases(good: Certificate, everywhere: Certificate) -> Iterator[Case]:
    """Bounds asked for: delta = 2^-40, mu = 16 prove 2^-21 / sqrt(1 - 2^-44) rad, 2^-39 / 79.2."""
    exact = stated(good, Fraction(1, 2**40), Fraction(16))
    angle = Fraction(1, 2**21) / root(1 - Fraction(1, 2**44))
    share = Fraction(1, 2**39) / root(Fraction(4 * 1568))
    in_words = (
        r"4\.77e-7 rad \(2\.74e-5 degrees\); asked for: 4\.768\S+e-7 rad",
        r"2\.30e-14; asked for: \S+",
    )
    for name, bound, printed in zip(("angle", "share"), (angle, share), in_words, strict=True):
        yield Case(f"{name}, inside", limited(exact, **{name: bound * (1 + NEAR)}), "VERIFIED")
        answer = rf"REFUSED: proved bound on the {name}: {printed}$"
        yield Case(f"{name}, outside", limited(exact, **{name: bound * (1 - NEAR)}), answer)
    both = limited(exact, angle=2 * angle, share=2 * share)
    yield Case("both limits", both, "VERIFIED")
    for one, other in ((Fraction(2), Fraction(1, 2)), (Fraction(1, 2), Fraction(2))):
        narrow = limited(exact, angle=one * angle, share=other * share)
        name = "angle" if one < 1 else "share"
        yield Case(f"{name} too large", narrow, f"REFUSED: proved bound on the {name}: ")
    none = "REFUSED: proved bound on the {}: none; asked for: 1{}$"
    loose = loosely(good, Fraction(1))
    yield Case("no angle", limited(loose, angle=Fraction(1)), none.format("angle", " rad"))
    yield Case("a gap alone", limited(loose, share=Fraction(1)), "VERIFIED")
    counts = counted(good, [1, 2, 4, 8], 2**61 - 1)
    for name, unit in (("angle", " rad"), ("share", "")):
        yield Case(
            f"count: {name}", limited(counts, **{name: Fraction(1)}), none.format(name, unit)
        )
    yield Case("range 0, share 0", limited(everywhere, share=Fraction(0)), "VERIFIED")
    yield Case("a limit that no double is", limited(good, share=Fraction(10**400)), "VERIFIED")
    loud = r"REFUSED: proved bound on the angle: none; asked for: 1\.?0*e\+400 rad$"
    yield Case("a limit so large", limited(loose, angle=Fraction(10**400)), loud)
    yield Case(
        "range 0, angle", limited(everywhere, angle=Fraction(1)), none.format("angle", " rad")
    )


def limited(certificate: Certificate, **limits: Fraction) -> Ask:
    """The checker's outcome in words under these limits."""

    def ask(checker: Any) -> str:
        outcome = checker.check(oracle.dump(certificate), None, limits)
        return "VERIFIED" if outcome.verified else "REFUSED: " + outcome.reason

    return ask


def root(value: Fraction) -> Fraction:
    """Dyadic, from below, to 100 bits behind the point."""
    return Fraction(isqrt(int(value * 2**200)), 2**100)


def command_cases() -> Iterator[Case]:
    text = oracle.dump(axes())
    with_space = text + b" "
    for name, content, limit, answer in (
        ("verified", text, None, "0 .*VERIFIED\n$"),
        ("refused", text.replace(b'"kind"', b'"Kind"'), None, "1 REFUSED: the certificate must"),
        ("empty", b"", None, "1 REFUSED: the certificate is not JSON .*"),
        ("at most", text, len(text), "0 .*VERIFIED\n$"),
        ("a byte more", with_space, len(text), "1 REFUSED: the certificate is too large\n$"),
    ):
        yield Case(f"command: {name}", run_on(content, limit), answer)
    yield from line_cases(json.dumps(json.loads(text)).encode())
    yield from stream_cases(text)
    yield Case("a pipe of the shell's", piped(text), "0 .*VERIFIED\n$")
    yield Case("no memory", short_of_memory, "2 .*: not enough memory: give a readable file\n$")
    for options, answer in (
        (["--max-gap", "1e-13"], "0 .*VERIFIED\n$"),
        (["--max-gap=1e-13", "--max-angle=1e-5"], "0 .*VERIFIED\n$"),
        (["--max-gap", "1e-14"], "1 REFUSED: proved bound on the share: 2.*; asked for: 1e-14\n$"),
        (
            ["--max-angle", "1e-7"],
            "1 REFUSED: proved bound on the angle: .*; asked for: 1e-7 rad\n$",
        ),
        *((["--max-gap", text], "2 usage") for text in ("", "x", "nan", "inf", "1/3", "-inf")),
        *(([f"--max-{name}=-1e-9"], "2 usage") for name in ("gap", "angle")),
        (["--max-gap", "1.00000000012e-14"], r"1 REFUSED: .*; asked for: 1\.00000000012e-14\n$"),
        (["--max-gap", "0"], "1 REFUSED: proved bound on the share: 2.*; asked for: 0\n$"),
        (["--max-gap"], "2 usage"),
        (["--max", "1"], "2 usage"),
    ):
        yield Case(f"command {options}", run_on(text, None, [*options, "FILE"]), answer)
    yield Case("an option behind", run_on(text, None, ["FILE", "--max-gap", "1e-14"]), "1 REFUSED")
    for arguments, answer in (
        ([], "2 usage"),
        (["--help"], "0 usage"),
        (["-x"], "2 usage"),
        (["a", "b"], "2 usage"),
        (["/nowhere/at/all"], "2 /nowhere/at/all: .*: give a readable file\n$"),
        (["/dev/null"], "2 /dev/null: a folder, a named pipe or a device: give a readable file\n$"),
        (["/"], "2 /: a folder, a named pipe or a device: give a readable file\n$"),
        (["nul\0byte"], r"2 nul\\x00byte: .*: give a readable file"),
    ):
        yield Case(f"command {arguments}", run_on(None, None, arguments), answer)
    shown = "repr of a long text, cut and escaped"
    for value, answer in (
        ("a\u2028b\x1b", r"'a\\\\u2028b\\\\x1b'$"),
        ("x" * 300, f"'{'x' * 200}'$"),
    ):
        yield Case(shown, value_of(lambda checker, value=value: checker.shown(value)), answer)


def stream_cases(good: bytes) -> Iterator[Case]:
    """The code is that of the verdict, or 2 where standard output cannot be written."""
    bad = good.replace(b'"kind"', b'"Kind"')
    for code, content in ((0, good), (1, bad)):
        full = "2 \\[1\\] the output cannot be written \\(full\\)\n$"
        for name, out, err, answer in (
            ("unread", Lost(errno.EPIPE), io.StringIO(), f"{code} \\[1\\] $"),
            ("unread when flushed", Lost(errno.EPIPE, late=True), io.StringIO(), f"{code} .1. $"),
            ("full", Lost(errno.ENOSPC), io.StringIO(), full),
            ("full when flushed", Lost(errno.ENOSPC, late=True), io.StringIO(), full),
            ("closed", None, io.StringIO(), r"2 .1. the output cannot .* \(it is closed\)\n$"),
            ("full, nor can that be said", Lost(errno.ENOSPC), None, r"2 \[1, 2\] $"),
            ("nothing to say on", io.StringIO(), None, rf"{code} \[\] $"),
        ):
            yield Case(f"output {name}: {code}", run_on_streams(content, out, err), answer)
    usage = run_on_streams(None, io.StringIO(), Lost(errno.ENOSPC))
    yield Case("output: usage", usage, r"2 \[2\] $")


class Lost(io.StringIO):
    """A stream that cannot be written, as is seen at once or when it is flushed."""

    def __init__(self, fault: int, *, late: bool = False) -> None:
        super().__init__()
        self.fault, self.late = fault, late

    def write(self, text: str) -> int:
        return len(text) if self.late else self._fail()

    def flush(self) -> None:
        self._fail()

    def _fail(self) -> int:
        raise OSError(self.fault, "full")


def run_on_streams(content: bytes | None, out: Any, err: Any) -> Ask:
    """Exit code of the command, descriptors that it turns away, and what it says on stderr."""

    def ask(checker: Any) -> str:
        turned: list[int] = []
        with (
            tempfile.NamedTemporaryFile() as file,
            mock.patch.object(os, "dup2", lambda handle, to: (os.close(handle), turned.append(to))),
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
        ):
            file.write(content or b"")
            file.flush()
            try:
                code = checker.main([file.name] if content else [])
            except SystemExit as stop:
                code = stop.code
            said = "" if err is None else err.getvalue()
            if err is not None:
                err.truncate(err.seek(0))
        return f"{code} {sorted(set(turned))} {said}"

    return ask


def piped(content: bytes) -> Ask:
    """The exit code for what stands in a pipe as the shell makes it."""

    def ask(checker: Any) -> str:
        reading, writing = os.pipe()
        os.write(writing, content)
        os.close(writing)
        try:
            return run_on(None, None, [f"/dev/fd/{reading}"])(checker)
        finally:
            os.close(reading)

    return ask


def short_of_memory(checker: Any) -> str:
    """What the command says where a check takes more memory than there is."""
    with mock.patch.object(checker, "check", side_effect=MemoryError):
        return run_on(b"{}", None)(checker)


def line_cases(good: bytes) -> Iterator[Case]:
    """Files with a certificate a line."""
    bad = good.replace(b'"kind"', b'"Kind"')
    key, text = "the certificate must have exactly .*", "the certificate is not JSON .*"
    for name, lines, limit, answer in (
        ("one", [good], None, "0 1 of 1 certificates VERIFIED\n$"),
        ("three", [good, good, good], None, "0 3 of 3 certificates VERIFIED\n$"),
        ("none", [], None, "1 0 of 0 certificates VERIFIED\n$"),
        ("bad", [bad], None, f"1 line 1: REFUSED: {key}\n0 of 1 certificates VERIFIED\n$"),
        (
            "some bad",
            [good, bad, good, b"", good + b"\r"],
            None,
            f"1 line 2: REFUSED: {key}\nline 4: REFUSED: {text}\n3 of 5 certificates VERIFIED\n$",
        ),
        ("two in a line", [good + good], None, f"1 line 1: REFUSED: {text}\n0 of 1 .*"),
        ("as long as may be", [good, good], len(good) + 1, "0 2 of 2 certificates VERIFIED\n$"),
        (
            "too long: no more is read",
            [good, good + b" ", good],
            len(good) + 1,
            "1 line 2: REFUSED: the certificate is too large\n1 of 2 certificates VERIFIED\n$",
        ),
    ):
        content = b"".join(line + b"\n" for line in lines)
        yield Case(f"lines: {name}", run_on(content, limit, named="many.jsonl"), answer)
    options = ["--max-gap", "1e-14", "FILE"]
    answer = "1 line 1: REFUSED: proved bound on the share: .*\n0 of 1 certificates VERIFIED\n$"
    yield Case("lines: asked", run_on(good, None, options, named="many.jsonl"), answer)


def run_on(
    content: bytes | None,
    limit: int | None,
    arguments: list[str] | None = None,
    named: str = "certificate.json",
) -> Ask:
    """Exit code, standard output and standard error of the command."""

    def ask(checker: Any) -> str:
        kept, given = checker.FILE_MAX, ["FILE"] if arguments is None else arguments
        out, err = io.StringIO(), io.StringIO()
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(out):
            path = Path(folder) / named
            path.write_bytes(content or b"")
            checker.FILE_MAX = kept if limit is None else limit
            try:
                with contextlib.redirect_stderr(err):
                    typed = [str(path) if each == "FILE" else each for each in given]
                    code = checker.main(typed)
            finally:
                checker.FILE_MAX = kept
        return f"{code} {out.getvalue()}{err.getvalue()}"

    return ask


def large_cases() -> Iterator[Case]:
    """The limits themselves, of files of a hundred megabytes."""
    good = axes()
    n = 10**6 + 1
    wide = changed(good, n=n, data="A" * ((26 + 56 * n + 2) // 3 * 4))
    yield Case("a million points and one", outcome_of(wide), "REFUSED: data is not of n points$")
    n = 10**6
    most = changed(good, n=n, data="A" * ((26 + 56 * n + 2) // 3 * 4))
    yield Case("a million points", outcome_of(most), "REFUSED: data is not canonical")
    text = oracle.dump(good)
    spaces = text + b" " * (10**8 - len(text))
    yield Case("10^8 bytes", outcome_of(spaces), "VERIFIED")
    yield Case("10^8 bytes and one", outcome_of(spaces + b" "), "REFUSED: the certificate is too l")


@cache
def _cases_by_subject() -> dict[str, list[Case]]:
    """Every case but those of large files; made once, a second's work."""
    example = Example.made()
    subjects = {
        "optimality": optimality_cases(),
        "claims": claim_cases(),
        "words": word_cases(),
        "count": count_cases(),
        "pattern": pattern_cases(),
        "short cuts": chain(modulus_cases(), leading_cases()),
        "basin": basin_cases(example),
        "general": general_cases(example),
        "radius": radius_cases(),
        "form": form_cases(),
        "data": data_cases(),
        "command": command_cases(),
    }
    return {name: list(cases) for name, cases in subjects.items()}


def quick_cases(*first: str) -> list[Case]:
    """Every case but those of large files; those about the subjects told stand first."""
    subjects = _cases_by_subject()
    return [case for name in dict.fromkeys([*first, *subjects]) for case in subjects[name]]
