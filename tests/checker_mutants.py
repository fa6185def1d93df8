"""Mutants of the trusted checker, and who notices: `python tests/checker_mutants.py`.

Each mutant changes one place of `certreg/verify.py`, in memory only, and is asked the questions of
`checker_boundaries`. One that answers all of them as it should has survived: it is a wrong checker
that every test lets pass.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from checker_boundaries import Case, quick_cases
from list_boundaries import early_list_cases, list_cases
from similarity_boundaries import similarity_cases
from springs_boundaries import springs_cases
from truncated_boundaries import truncated_cases

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import CodeType

FILE = Path(__file__).resolve().parent.parent / "certreg" / "verify.py"


@dataclass(frozen=True)
class Mutant:
    """A change of the checker from `old`, which stands there once, to `new`."""

    old: str
    new: str

    @property
    def says(self) -> str:
        """The change on one line."""
        return f"{self.old} -> {self.new}"


def mutants(*changes: tuple[str, ...]) -> tuple[Mutant, ...]:
    """One for each replacement of each text."""
    return tuple(Mutant(old, new) for old, *others in changes for new in others)


LIMITS = mutants(
    ("FILE_MAX = 10**6, 10**8", "FILE_MAX = 10**7, 10**8", "FILE_MAX = 10**6, 10**9"),
    ("NODES_MAX = 50_000", "NODES_MAX = 50_001", "NODES_MAX = 49_999"),
    ("DIGITS_MAX, EXPONENT_MAX = 4300", "DIGITS_MAX, EXPONENT_MAX = 4301"),
    (", EXPONENT_MAX = 4300, 32768", ", EXPONENT_MAX = 4300, 32769"),
    ("len(text) <= FILE_MAX and nodes", "len(text) < FILE_MAX and nodes"),
    ("nodes <= NODES_MAX", "nodes < NODES_MAX"),
    ('(b",", b"[", b"{")', '(b",", b"[")', '(b",", b"{")', '(b"[", b"{")'),
    ("len(digits) <= DIGITS_MAX", "len(digits) < DIGITS_MAX", "True"),
    (
        "require(abs(exponent) <= EXPONENT_MAX",
        "require(exponent <= EXPONENT_MAX",
        "require(abs(exponent) < EXPONENT_MAX",
    ),
    ("len(pairs) == len(found := dict(pairs))", "(found := dict(pairs)) is not None"),
    ("value.__class__ is TYPES.get(kind)", "isinstance(value, TYPES.get(kind, ()))"),
    ("MODULUS_MAX = 2**64", "MODULUS_MAX = 2**63", "MODULUS_MAX = 2**65"),
    ("read(FILE_MAX + 1)", "read(FILE_MAX)"),
    ("len(text) <= FILE_MAX and ((text", "(True) and ((text"),
)
DATA = mutants(
    ("1 <= n < 2**40", "0 <= n < 2**40", "1 < n < 2**40", "1 <= n <= 2**40", "1 <= n < 2**39"),
    ("n <= INLINE_MAX and", "n < INLINE_MAX and", ""),
    ("content.startswith(head) and", ""),
    ("and text.endswith(last)", ""),
    ("len(part) for part in parts", "len(part) for part in parts[:2]"),
    (
        "content.startswith(given[: size - 8 * own])",
        "True",
        "content.startswith(given[: size - 8])",
    ),
    ("else content.startswith(given)", "else True", "else content.startswith(given[:-8])"),
    ("equal and (clouds.any_weight", "(clouds.any_weight"),
    ("told if equal else", "told if True else", "told if False else"),
    ("'1' if bare else 'as given'", "'1'", "'as given'"),
    ("bytes(doubles[-8 * stated.n :]) == bytes(doubles[-8:]) * stated.n", "True", "False"),
    ("content[-8:] * own == content[-8 * n :]", "True", "False"),
    ('digest == certificate.digest, "the', 'digest, "the'),
    ("min(w) >= 0", "min(w) > 0", "True"),
    ("all(map(isfinite, values))", "True"),
    ("1 << 63 not in bits", "True", "1 << 63 not in bits[1:]"),
    ("if 0.0 in values else ()", "if 0.0 in values[1:] else ()", "if 0.0 in values[:-1] else ()"),
    ("map(mul, loads, right)", "map(mul, left, right)", "map(mul, loads, left)"),
    ("right if unit and not i else", "right if unit else", "right if not i else"),
    ("sum(terms if near else", "sum(terms if True else"),
    ("if w.count(w[0]) == count else 0", "if near else 0"),
    ("left if unit else", "left if near else", "left if w[0] else"),
    ("total * (unit or 1)", "total", "total * (w[0] or 1)"),
    ("(m[i][j] << old - e) +", "", "m[i][j] +", "(m[i][j] >> old - e) +"),
    ("<< low + p + q - e)", "<< low + p - e)", "<< low + q - e)", "<< low + 2 * p - e)", ")"),
    ("a[i : 7 if i < 4 else i + 1], i)", "a[i : 7 if i < 4 else i + 1])", "a[i : i + 1], i)"),
    (
        "a[i : 7 if i < 4 else i + 1]",
        "a[i : 6 if i < 4 else i + 1]",
        "a[i : 7 if i < 3 else i + 1]",
    ),
    ("map(add, shifts, t)", "shifts", "t"),
    ("s if near else [*map(add, g, s)]", "s", "g", "s if unit else g"),
    ("not any(chain(x[1], y[1], g))", "not any(x[1])", "not any(y[1])", "not any(g)", "True"),
    (
        "old, e = not any(chain(x[1], y[1], g)), e, min(e, ",
        "old, e = not any(chain(x[1], y[1], g)), e, max(e, ",
    ),
    ("min(0, x[2], y[2])", "min(x[2], y[2])", "min(0, x[2])", "min(0, y[2])", "0"),
    (
        "map(int, map(ldexp, values, map(neg, e)))",
        "map(int, values)",
        "map(int, map(ldexp, values, e))",
    ),
    ("map(ldexp, values, repeat(-low))", "map(ldexp, values, repeat(low))", "values"),
    ("frexp(v)[1] - 53", "frexp(v)[1] - 52", "frexp(v)[1]"),
    ("frexp(min(sizes))[1] - 53", "frexp(min(sizes))[1] - 52", "frexp(min(sizes))[1]"),
    ("frexp(max(sizes))[1] - 53", "-1100"),
    ("filter(None, map(abs, values))", "filter(None, values)", "map(abs, values)"),
    ("or [0.0]", ""),
    ("if v else low for v", "if v else 0 for v", "for v"),
    ("[k - low for k in e]", "e", "[k + low for k in e]", "[0] * count"),
    ("if high - low <= NEAR", "if high - low <= 10 * NEAR"),
    ("clouds.any_weight or w == 1", "True", "w == 1", "clouds.any_weight", "w >= 1", "w <= 1"),
    ("clouds.weights is None\n        content", "True\n        content", "False\n        content"),
    ("{w**-0.5:.6g}", "{w**-0.5:.3g}", "{w**0.5:.6g}", "{w**-1:.6g}"),
    ("float(1 / Fraction(sigma) ** 2) == w", "True", "False"),
    ("if 1e-300 < w < 1e300", "if True", "if 1e-300 < w", "if w < 1e300"),
    ("6 * n + start", "6 * n"),
    ("3 * (n + start)", "3 * n + start"),
)
SUMS = mutants(
    ("b + d, c + g, f + h, h - f", "b - d, c + g, f + h, h - f", "b + d, c + g, f + h, f - h"),
    ("c - g, d - b\n", "g - c, d - b\n", "c - g, b - d\n"),
    ("c + g, f + h, h", "c - g, f + h, h", "c + g, f - h, h"),
    ("[a + e + i, x, y, z]", "[a + e - i, x, y, z]", "[a + e + i, y, x, z]"),
    ("[x, a - e - i, s, t]", "[x, a + e - i, s, t]", "[x, a - e - i, t, s]"),
    ("[y, s, e - a - i, u]", "[y, s, e - a + i, u]", "[y, s, e - a - i, 0]"),
    ("[z, t, u, i - a - e]", "[z, t, u, i - a + e]", "[z, t, u, a - i - e]"),
    ("return p > 0 and", "return p >= 0 and", "return p != 0 and", "return"),
    ("p * a - right[i] * b", "p * a + right[i] * b", "p * a - right[0] * b"),
    ("not B or", "len(B) < 2 or"),
    ("right[i] * b) // last", "right[i] * b) // 1 // (last or 1) ** 2"),
)
ISOTROPIC = mutants(
    ("sum(c * c for c in q) * unit", "sum(c * c for c in q)", "2 * sum(c * c for c in q) * unit"),
    ("mu * q[i] * q[j]", "mu", "mu * q[i] * q[i]", "mu * q[j]"),
    ("- n * K[i][j]", "+ n * K[i][j]", "- K[i][j]", ""),
    ("+ level * (i == j)", "+ level", "- level * (i == j)"),
    ("over = max([-e, *[", "over = max([*[", "over = min([-e, *["),
    ("numbers = self.delta, self.gap, self.mu,", "numbers = self.delta, self.gap, 0 * self.mu,"),
    ("self.mu if self.nu is None else self.nu", "self.nu or self.mu"),
    ("one, unit = mass << over", "one, unit = 1 << over"),
    ("1 << over + e  #", "1 << over  #", "1  #"),
    ("zeros[0] // 2, *zeros", "zeros[0], *zeros", "*zeros"),
    ("[zeros[0] // 2, *zeros[1:]]", "[zeros[0] // 2]"),
    ("m[0][0] >> 2 * z", "m[0][0] >> z"),
    ("k >> z for k", "k >> 2 * z for k"),
    ("quadratic(K, self.pose) * unit +", "quadratic(K, self.pose) +"),
    # Of bits cut off, n times 2^s for n = 2 is the most there can be: 4 is more than is needed.
    ("- 4 * (j == 0 < s)", "", "- (j == 0 < s)"),
    ("definite(B) or (s > 0 and definite(A, 2 * bits))", "definite(B)"),
    ("if square % PRIME or", "if square or", "if True or"),
    ("or (A is C and square)", "", "or square", "or A is C"),
    ("multiplicities(C), definite(J, 64)", "multiplicities(C), True"),
    ("for row in C], C)", "for row in C],)"),
    ("[e * i - f * h,", "[e * i + f * h,", "[e * h - f * i,"),
    ("f * g - d * i", "d * i - f * g", "f * g - a * i"),
    ("d * h - e * g]", "e * g - d * h]", "d * h]"),
    ("c * h - b * i", "c * h", "b * i"),
    ("a * i - c * g", "a * i", "c * g"),
    ("b * g - a * h", "b * g", "a * h"),
    ("b * f - c * e", "b * f", "c * e"),
    ("c * d - a * f", "c * d", "a * f"),
    ("a * e - b * d", "a * e", "b * d"),
    ("sum(map(mul, p, p))", "p[0] ** 2", "sum(p)"),
    ("sum(map(mul, q, q))", "q[0] ** 2", "sum(q)"),
    (
        "Fraction(quadratic(J, w), 4)",
        "Fraction(quadratic(J, w), 8)",
        "Fraction(quadratic(J, w), 3)",
        "0",
    ),
    (
        "_dyadic(1, exponent) ** 2",
        "_dyadic(1, exponent)",
        "_dyadic(1, exponent - 1) ** 2",
        "_dyadic(1, -exponent) ** 2",
        "_dyadic(1, 0) ** 2",
    ),
    ("return any(p) and", "return"),
    ("- spin > level", "- spin >= level", "+ spin > level"),
    ("- 27 * e3**2", "- 26 * e3**2", "+ 27 * e3**2"),
    ("e1**2 * e2**2 - 4 * e2**3", "e1**2 * e2**2 + 4 * e2**3"),
    ("18 * e1 * e2 * e3", "17 * e1 * e2 * e3"),
    ("if e2 == 0", "if D == 0"),
    ("[2, 2] if e1 else [4]", "[2, 2]", "[4]"),
    ("- 9 * e1 * e2 + 27 * e3", "- 9 * e1 * e2 + 9 * e3", "+ 9 * e1 * e2 + 27 * e3"),
    ("[1, 3] if D > 0 else [3, 1]", "[1, 3]", "[1, 3] if D < 0 else [3, 1]"),
    ("[1, 2, 1] if s < 0", "[1, 2, 1] if s > 0", "[1, 2, 1] if s <= 0 or D < 0"),
    ("else [1, 1, 2] if D > 0", "else [1, 1, 2] if D < 0", "else [1, 1, 2] if True"),
    ("self.delta.numerator > 0 <= self", "self.delta.numerator >= 0 <= self", "0 <= self"),
    ("0 <= self.mu.numerator and", "0 < self.mu.numerator and", "0 and"),
    ("self.mu.numerator and any(self.pose)", "self.mu.numerator"),
    ('require(m[0][0] >= 1, "no', 'require(m[0][0] >= 0, "no'),
    *(
        (f"m[0][0] * m[j][k] - m[0][j] * m[0][k]{end}", f"m[0][0] * m[j][k]{end}", f"m[j][k]{end}")
        for end in (" for j in (1, 2, 3)", " for k in range(j, 4)")
    ),
    ("m[0][k] for k in range(j, 4)", "m[0][k] * -1 for k in range(j, 4)"),
    ("[d + f, -b, -c]", "[d + f, b, c]", "[a + d, -b, -c]", "[d + f, 0, 0]"),
    ("[-b, a + f, -e]", "[-b, d + f, -e]"),
    ("[-c, -e, a + d]", "[-c, -e, a + f]"),
    (
        "* unit + (delta - mu) * norm",
        "* unit + delta * norm",
        "* unit + (2 * delta - mu) * norm",
        "* unit + (delta / 2 - mu) * norm",
        "* unit + (delta - mu)",
    ),
    ("proves_level(K, unit, self.pose, level, mu)", "True"),
    ('require(bounded, "claims.sin2', 'require(True, "claims.sin2'),
    ("self._require_equilibria(pattern, solid=solid)\n", "\n"),
    ("good = list(self.pattern) == true", "good = set(self.pattern) == set(true)", "good = True"),
    ("list(self.unstable) == unstable", "len(self.unstable) == len(unstable or [])"),
    (
        '>= 2 * delta, "claims.gap',
        '> 2 * delta, "claims.gap',
        '>= delta, "claims.gap',
        '>= 2 * delta * (1 - Fraction(1, 2**31)), "claims.gap',
    ),
    (
        "angle.numerator * mu >= delta * angle.denominator",
        "mu > 0",
        "angle.numerator * mu > delta * angle.denominator",
        "2 * angle.numerator * mu >= delta * angle.denominator",
    ),
    ("true[0] == 1 or not", "True or not"),
    ("accumulate(true[:-1])] if solid", "accumulate(true[:-1])] if True"),
    (
        "not dual or proves_level(K, unit, q, nu * norm, 0)",
        "not dual or nu * norm >= level",
        "True",
        "not dual or proves_level(K, unit, q, nu * norm, mu)",
        "not dual or proves_level(K, unit, q, nu, 0)",
        "not dual or proves_level(K, unit, q, 2 * nu * norm, 0)",
    ),
    ("(dual and sdp", "(sdp"),
    (
        "sdp * one * norm >= 2 * (nu * norm - v))",
        "sdp * one * norm >= nu * norm - v)",
        "sdp * one * norm > 2 * (nu * norm - v))",
        "sdp * one * norm >= 2 * (nu - v))",
        "sdp > 0)",
    ),
    (
        "Fraction(level, norm * unit)",
        "Fraction(level, norm)",
        "Fraction(v, norm * unit)",
        "Fraction(level - delta * norm, norm * unit)",
    ),
    ("inside = solid and p and w and", "inside = solid and (not p or not w) or"),
    ('require(inside, "', 'require(inside or True, "'),
    ("        if self.basin:\n            p, w", "        if not self.basin:\n            p, w"),
)
WORTH = mutants(
    ("weight, q, norm = _dyadic(m[0][0], e)", "weight, q, norm = Fraction(m[0][0])"),
    ("sum(c * c for c in self.pose), 2 * self.delta", "sum(c * c for c in self.pose), self.delta"),
    (
        "m[0][0] * m[k][k] - m[0][k] ** 2",
        "m[0][0] * m[k][k]",
        "m[k][k] - m[0][k] ** 2",
        "m[0][0] * m[k][k] + m[0][k] ** 2",
    ),
    (
        "(x + y) * unit * norm - 2 * v",
        "(x + y) * unit * norm - v",
        "(x + y) * unit * norm + 2 * v",
        "(x + y) * unit - 2 * v",
        "(x + y) * norm - 2 * v",
        "(x + x) * unit * norm - 2 * v",
        "y * unit * norm - 2 * v",
    ),
    ("for k in (i, i + 1, i + 2)])", "for k in (i, i + 1)])", "for k in (i, i, i + 2)])"),
    ("for i in (1, 4)]", "for i in (4, 1)]", "for i in (1, 3)]", "for i in (4, 4)]"),
    ("Fraction(objective, one * norm)", "Fraction(objective, norm)", "Fraction(objective, one)"),
    ("(abs(k) << BITS >> bits) ** 2", "abs(k) << BITS >> bits"),
    ("** 2 for k in chain(*K)]))", "** 2 for k in K[0]]))"),
    ("abs(k) << BITS >>", "abs(k) << 255 >>", "abs(k) << 257 >>"),
    ("Fraction(delta << BITS, F", "Fraction(2 * delta << BITS, F", "Fraction(one << BITS, F"),
    ("F * unit << bits)", "F * unit)", "F << bits)", "F * one << bits)"),
    ("if F else Fraction(0)", "if F else Fraction(1)"),
    ("root_up(4 * delta, mu - delta)", "root_up(delta, mu - delta)"),
    ("(4 * delta, mu - delta)", "(4 * delta, mu)", "(4 * delta, mu + delta)"),
    ("if mu > delta else None", "if mu > 2 * delta else None"),
    (
        "10**8 * angle.numerator < 314159265 * angle.denominator",
        "10**8 * angle.numerator < 630000000 * angle.denominator",
        "True",
        "10**8 * angle.numerator < 160000000 * angle.denominator",
    ),
    (
        "max(objective - 2 * delta * norm, 0)",
        "max(objective, 0)",
        "objective - 2 * delta * norm",
        "max(objective - delta * norm, 0)",
        "max(objective - 2 * delta, 0)",
    ),
    ("norm, 0), one * norm)", "norm, 0), one)", "norm, 0), norm)"),
    (
        "root_up(2 * delta * weight.denominator, one * weight.numerator)",
        "root_up(2 * delta, one)",
        "root_up(2 * delta * weight.numerator, one * weight.denominator)",
        "root_up(delta * weight.denominator, one * weight.numerator)",
    ),
    ("// d) + 1, 1 << s)", "// d), 1 << s)"),
    ("s = max(70 + (", "s = max(40 + ("),
    ('Fraction("57.295779514")', 'Fraction("28.6478897566")'),
    ('least = f"{rounded(w.minimum, 12, ROUND_FLOOR)', 'least = f"{rounded(w.minimum, 12)'),
    (
        "rounding: str = ROUND_CEILING",
        "rounding: str = ROUND_FLOOR",
        "rounding: str = 'ROUND_HALF_EVEN'",
    ),
    ("if w.share >= 1", "if w.share >= 2", "if False"),
    ("yield part if w.share else", "yield part if True else"),
    ("        if w.angle is not None:", "        if w.angle is not None and w.angle <= 2:"),
    ("self.sdp_gap * w.share >= w.gap", "self.sdp_gap >= w.gap", "False"),
    (
        "bound is not None and bound <= limit",
        "bound is not None",
        "bound is None or bound <= limit",
    ),
    ("and bound <= limit", "and bound < limit"),
    ("if bound and unit else", "if False else", "if bound else"),
    ("bound * DEGREES, 3", "bound, 3", "bound * DEGREES, 1"),
    ('" rad" * (name == "angle")', '" rad"', '""'),
    ("all(limit >= 0 for", "all(True for", "all(limit > 0 for"),
    ("getattr(outcome.worth, name, None)", "getattr(outcome.worth, 'share', None)"),
    ("return within(stated.prove(", "return (lambda outcome, limits: outcome)(stated.prove("),
    ("check(text, limits=limits)", "check(text)"),
    ("0 < good == total", "0 < total", "0 < good", "good == total"),
    ("or not (many or total)", ""),
    ("if not (many and outcome.verified)", "if not many", "if not outcome.verified", "if True"),
    ("file.readline if many", "file.read if many"),
    ('path.endswith(".jsonl")', "False", "True"),
    ('VERIFIED\\n" * many', 'VERIFIED\\n"', 'VERIFIED\\n" * (not many)'),
    ('f"line {total}: " * many', '""', 'f"line {good}: " * many'),
    ('"max-angle": "angle", "max-gap": "share"', '"max-angle": "share", "max-gap": "angle"'),
    ("Fraction(repr(float(text)))", "Fraction(float(text))", "Fraction(text)"),
)
RADIUS = mutants(
    (
        "min(s.numerator, target.numerator, both",
        "min(target.numerator, both",
        "min(s.numerator, both",
    ),
    ("target.numerator, both.numerator)", "target.numerator)"),
    ("if least > 0 and 2 * n * n <= d * d", "if least > 0 and n * n <= d * d", "if least > 0"),
    ("keeps(Fraction(0), target)", "True", "keeps(Fraction(0), target / 2)"),
    ("and keeps(both, both)", "and keeps(Fraction(0), both)", "and keeps(both, Fraction(0))"),
    ('require(proved, "radius', 'require(True, "radius'),
    ("(120 * d * d * c + 20", "(60 * d * d * c + 20", "(120 * d * d * c + 60"),
    ("+ 9 * n**4", "+ 90 * n**4", "- 90 * n**4"),
    ("root_up(d * d - n * n,", "root_up(d * d - n * d,"),
    ("Fraction(2 * n, d) *", "Fraction(n, d) *", "Fraction(4 * n, d) *"),
    (
        "g * (sine_below(s) - angle) / 2",
        "g * (sine_below(s) - angle)",
        "g * sine_below(s) / 2",
        "(sine_below(s) - angle) / 2",
    ),
    ("+ 1) * unit * sum(c", "+ 1) * sum(c"),
    ("* unit * g.denominator - g.n", "* unit * g.denominator + g.n", "* unit - g.n"),
    (
        "g.numerator * one * sum(c * c for c in q)",
        "g.numerator * one",
        "g.numerator * sum(c * c for c in q)",
    ),
    ("K, unit * g.denominator, q", "K, unit, q"),
    ("require(g.numerator > 0 and angle and", "require(g.numerator > 0 and", "require(angle and"),
    ("and angle and alone", "and angle"),
    ("_dyadic(1, e + z)", "_dyadic(1, e)", "_dyadic(1, e + 2 * z)", "_dyadic(1, z)"),
    ("(y + weight * dy) * dx + x * dy", "weight * dy * dx + x * dy", "(y + weight * dy) * dx"),
    ("(y + weight * dy) * dx + x * dy", "(y + weight * dy) * dx + y * dy"),
    ("(y + weight * dy) * dx", "y * dx", "(y + dy) * dx"),
    ("        yield from steady\n", ""),
    (
        "self.target) == (None, None, None):\n            return ()",
        "self.target) == ():\n            return ()",
    ),
    (
        "self.target) == (None, None, None):\n            return ()",
        "self.target) == () or self.sin_half_angle is None:\n            return ()",
        "self.target) == () or self.both is None:\n            return ()",
        "self.target) == () or self.target is None:\n            return ()",
    ),
    ("rounded(r, 3, ROUND_FLOOR)", "rounded(r, 3)"),
    ("document.get(name) is None", "document[name] is None"),
)
COUNT = mutants(
    ("(1 if i == 0 else -1)", "1", "-1"),
    ("A[i - 1][j - 1] += 2", "A[i - 1][j - 1] += 1"),
    ("+= 2 * (i != j)", "+= 2"),
    ("A[b][a], A[a][b] = 2, -2", "A[b][a], A[a][b] = -2, 2", "A[b][a], A[a][b] = 2, 2"),
    ("product[i][j] - product[j][i]", "product[i][j] + product[j][i]", "product[i][j]"),
    ("gcd(entry, modulus) == 1", "entry != 0", "gcd(entry, modulus) >= 1"),
    ("if k is not None:\n            inverse", "if True:\n            inverse"),
    ("if len(pivots) == wanted:", "if len(pivots) == wanted - 1:", "if len(pivots) >= 0:"),
    ("(1 << 8 * size)) % modulus * pivot", "(1 << 8 * size)) * pivot"),
    ("row += -(", "row += ("),
    ("(entry % modulus).to_bytes", "(abs(entry)).to_bytes"),
    ("[entry * inverse for entry", "[entry for entry"),
    ("(2 * modulus.bit_length() +", "(modulus.bit_length() +"),
    (
        "1 < self.modulus < MODULUS_MAX",
        "1 <= self.modulus < MODULUS_MAX",
        "1 < self.modulus <= MODULUS_MAX",
        "2 < self.modulus < MODULUS_MAX",
        "self.modulus < MODULUS_MAX",
        "1 < self.modulus",
    ),
    ("chart[j] * (i == k) + chart[i]", "chart[j] * (i == k) - chart[i]", "(i == k) + chart[i]"),
    ("j == k and i != j", "j == k"),
    ('require(independent, "', 'require(True, "'),
    ('>= 4, "claims.at_most', '> 4, "claims.at_most', '>= 3, "claims.at_most'),
    ("require(m[0][0] > 0", "require(m[0][0] >= 0"),
)
FORM = mutants(
    (
        "needed <= part.keys() <= known",
        "needed <= part.keys()",
        "part.keys() <= known",
    ),
    ("absent = name != place and", "absent ="),
    ("not a {FORMAT} of a known kind", "no {FORMAT}"),
    ('document["about"].__class__ is dict and', ""),
    ("and form.kind == kind", ""),
    ('known and document["format"] == FORMAT', "known", 'document["format"] == FORMAT'),
    ("if value.__class__ is TYPES.get(kind) or", "if kind in TYPES or"),
    ("null and value is None", "value is None", "False"),
    ("require(kind in LENGTHS and", "require("),
    ("and value.__class__ is list", ""),
    ("len(value) in LENGTHS[kind] and", ""),
    ("and {*map(type, value)} <= {int}", ""),
    ("<= {int}", "<= {int, bool}", "== {int}"),
    (
        "return _dyadic(*value)",
        "return _dyadic(*value[::-1])",
        "return _dyadic(value[0], -value[1])",
    ),
    ("Fraction(number << exponent)", "Fraction(1 << exponent)"),
    ("Fraction(number, 1 << -exponent)", "Fraction(1, 1 << -exponent)"),
    ("    unique: bool\n", "    unique: bool | None\n"),
    ("    basin: bool | None ", "    basin: bool "),
    ("    pattern: tuple[int, ...]", "    pattern: tuple[int, ...] | None"),
    ("    unstable: tuple[int, ...] | None", "    unstable: tuple[int, ...]"),
    ("    gap: Fraction\n    mu:", "    gap: Fraction | None\n    mu:"),
    ("    sdp_gap: Fraction | None", "    sdp_gap: Fraction"),
    (
        "    sin2_half_angle: Fraction | None\n\n",
        "    sin2_half_angle: Fraction\n\n",
    ),
    ("    nu: Fraction | None", "    nu: Fraction"),
    ("    delta: Fraction\n", "    delta: Fraction | None\n"),
    ('"Fraction": (2,)', '"Fraction": (2, 3)', '"Fraction": (1, 2)'),
    ("(4,), ", "(4, 5), ", "(3, 4), "),
    ("range(5)}", "range(6)}", "range(4)}"),
    ("entries.update(part)", "entries = {**part, **entries}"),
    ('"sdp?": "nu"', '"sdp": "nu"', '"sdp?": "nu?"'),
    ('"basin?": "ang', '"basin": "ang'),
    (
        "R is its rotation\n    pattern",
        "R is its rotation\n    pose: tuple[int, int, int, int] | None\n    pattern",
    ),
    (
        "    quaternion: tuple[int, int, int, int] | None",
        "    quaternion: tuple[int, int, int, int]",
    ),
    (
        "    modulus: int\n    chart: tuple[int, int, int, int]",
        "    modulus: int\n    chart: tuple[int, int, int, int] | None",
    ),
    ("    at_most: int\n", "    at_most: int | None\n"),
    (
        "SimilarityStatement, CountStatement, Spr",
        "SimilarityStatement, SimilarityStatement, Spr",
    ),
)
SPRINGS = mutants(
    ("3 * (n + first)]", "3 * n]"),
    ("[6 * (n + first)]", "[6 * n]"),
    ("[1 << -p] * count", "[1] * count"),
    ("2 * (g + p), low", "2 * (g + p), e"),
    ("(i << high - low) +", "i +"),
    ("(j << e - low) for", "j for"),
    ("most - low <= 3 * BITS", "most - low < 3 * BITS", "True"),
    ("(max(s) + e for _, s, e", "(e for _, s, e"),
    ("plus((b, b), (c, c))", "plus((b, b))"),
    ("plus((b, d), (c, e))", "plus((b, d), (c, c))"),
    ("plus((d, d), (e, e), (f, f))", "plus((d, d), (e, e))"),
    ("(1, 3, 4), (2, 4, 5))", "(1, 3, 4), (2, 3, 5))"),
    ("-sum(map(mul, forces[k], left))", "sum(map(mul, forces[k], left))"),
    ('require(weight > 0, "all', 'require(weight >= 0, "all'),
    ("free + (p == 0)", "free + (p != 0)"),
    ("(p * a - h[i] * b) // last for", "(p * a - h[i] * b) for"),
    ("_dyadic(1, e) / last, free", "_dyadic(1, e), free"),
    ("weight * _dyadic(1, e) / 3", "weight * _dyadic(1, e)"),
    ("s * t * (1 + (left is not right))", "s * t"),
    ("+13+13-02-02", "+13+13+02+02"),
    ("sum(c * c for c in q) ** 2)", "sum(c * c for c in q))"),
    ("require(stated.gap >= delta", "require(stated.gap > 0"),
    (
        "sin2 is None or 0 < delta <= sin2 * mu",
        "sin2 is None or 0 < delta <= sin2",
        "sin2 is None or delta <= sin2 * mu",
        "True",
    ),
    ("one = 0 < 4 * max(", "one = 0 < 3 * max(", "one = 0 < 5 * max(", "one = 4 * max("),
    ("max(width, 2 * mu)", "width"),
    ("* delta <= mu**2", "* delta <= mu"),
    ("(one if unique else several)", "one", "several", "(one or several)"),
    ("stated.symmetry is not None and is_symmetry(f.F, stated.symmetry)", "True"),
    ("e * e + f * f and not any(slope.values())", "e * e + f * f"),
    ("return a * a + b * b + c * c != d * d + e * e + f * f and", "return"),
    ("[a + d, 0, f - c, b - e]", "[a + d, 0, c - f, b - e]"),
    ("(5 - 2 * k) for k, c in zip(SQUARE, F)", "1 for k, c in zip(SQUARE, F)"),
    ("/ 24 - value)", "/ 23 - value)"),
    ("(4 * s / (1 - s))", "(4 * s)", "(s / (1 - s))"),
    ("s < Fraction(7, 10)", "s <= Fraction(7, 9)", "s < Fraction(1, 2)"),
    ("max(value - delta, 0)", "value - delta", "value"),
    ('rounded(w.minimum, 12, ROUND_FLOOR):g}."\n    part', 'rounded(w.minimum, 12):g}."\n    part'),
    ('if w.share < 1 else "bounds', 'if w.share < 2 else "bounds'),
    ('" if w.share else all_', '"'),
    ("if stated.unique is not None else", "if stated.unique is None else"),
    ("ERROR = 2 * len(QUARTICS)", "ERROR = 0", "ERROR = 2"),
    ("norm > 0 and self.mu >= 0 <= k <= BITS", "norm > 0 and self.mu >= 0 and k <= BITS"),
    ("self.mu >= 0 <= k <= BITS", "self.mu >= -1 <= k <= BITS", "self.mu >= 0 <= k < BITS"),
    ("good = norm > 0 and self.mu", "good = self.mu"),
    ("abs(self.unit) <= EXPONENT", "abs(self.unit) < EXPONENT", "self.unit <= EXPONENT"),
    ("largest >> BITS == 0", "largest >> BITS <= 1", "largest >> BITS - 1 == 0", "True"),
    ("(*F, *gram, level, mu)", "(*F, *gram, level)", "(*F, *gram, mu)"),
    ("abs, (*F, *gram, level", "abs, (*F, level", "abs, (*gram, level"),
    ("* mu // norm**2", "* mu // norm"),
    ("2 * (level + mu) * (1 + (i < j))", "2 * level * (1 + (i < j))", "2 * (level + mu)"),
    ("require(positive_definite(G), ", "require(G, "),
    ("(level - ERROR) * unit", "level * unit"),
    ("for c in gram])\n        for row", "for c in gram[::-1]])\n        for row"),
    ("left[monomial] -= G[i][j]", "left[monomial] += G[i][j]"),
    ("return [[2 * row[0], *row[1:]] for row in G]", "return G"),
)
# Beside each the subjects whose questions notice most of its mutants: these are asked first.
GROUPS = (
    (LIMITS, ("form", "count", "data")),
    (DATA, ("data",)),
    (FORM, ("form",)),
    (
        SUMS + ISOTROPIC,
        ("optimality", "claims", "words", "general", "pattern", "short cuts", "basin"),
    ),
    (WORTH, ("words", "command")),
    (RADIUS, ("radius",)),
    (COUNT, ("count",)),
)
LISTS = mutants(
    (
        "ENTRY_MAX, MODULI_MAX = 2**16",
        "ENTRY_MAX, MODULI_MAX = 2**15",
        "ENTRY_MAX, MODULI_MAX = 2**17",
    ),
    (", MODULI_MAX = 2**16, 2**62", ", MODULI_MAX = 2**16, 2**61", ", MODULI_MAX = 2**16, 2**63"),
    ("CYCLE = (1, 2), (2, 0), (0, 1)", "CYCLE = (1, 2), (0, 2), (0, 1)"),
    (
        "0 < max(map(abs, self.chart)) <= ENTRY_MAX",
        "max(map(abs, self.chart)) <= ENTRY_MAX",
        "0 < max(map(abs, self.chart)) < ENTRY_MAX",
        "0 < max(self.chart) <= ENTRY_MAX",
    ),
    (
        "0 <= self.bits <= BITS",
        "self.bits <= BITS",
        "0 < self.bits <= BITS",
        "0 <= self.bits < BITS",
        "0 <= self.bits",
    ),
    (
        "1 < self.modulus < MODULI_MAX",
        "1 <= self.modulus < MODULI_MAX",
        "1 < self.modulus <= MODULI_MAX",
        "1 < self.modulus",
        "2 < self.modulus < MODULI_MAX",
    ),
    (
        "max(map(abs, numbers)) >> 2 * BITS == 0",
        "True",
        "max(numbers) >> 2 * BITS == 0",
        "max(map(abs, numbers)) >> BITS == 0",
    ),
    ("if not any(map(itemgetter(1), P))]", "if not all(map(itemgetter(1), P))]", "if not P[1][1]]"),
    (
        "[[(x, -y) for x, y in P] for P in lines if P not in real]",
        "[P for P in lines if P not in real]",
        "[]",
    ),
    (
        "len(boxes) == 40 and min(far) > 4",
        "len(boxes) == 40",
        "min(far) > 4",
        "len(boxes) >= 40 and min(far) > 4",
        "len(boxes) <= 40 and min(far) > 4",
        "len(boxes) == 40 and min(far) >= 4",
        "len(boxes) == 40 and min(far) > 5",
    ),
    ("far = [max([(a - c)", "far = [min([(a - c)", "far = [sum([(a - c)"),
    ("(a - c) ** 2 + (b - d) ** 2 for", "(a - c) ** 2 for", "(b - d) ** 2 for"),
    (
        "[x, w, -z, y], [y, z, w, -x], [z, -y, x, w]]  # a p",
        "[x, w, z, -y], [y, z, w, -x], [z, -y, x, w]]  # a p",
    ),
    ('require(are_forty(minors, self.modulus), "', 'require(True, "'),
    ("[slopes_at(P, tables, most) for P in lines]", "[slopes_at(P, tables, most) for P in real]"),
    (
        'require([*self.indices] == indices, "',
        'require(len(self.indices) == len(indices), "',
        'require(sorted(self.indices) == sorted(indices), "',
    ),
    (
        "springs.unit * sum(map(abs, G.values())) / 12)",
        "springs.unit * max(map(abs, G.values())) / 12)",
        "springs.unit * sum(map(abs, G.values())) / 13)",
    ),
    (
        "u[i] * q[0][j] == u[j] * q[0][i] for i, j",
        "u[i] * q[1][j] == u[j] * q[1][i] for i, j",
        "True for i, j",
    ),
    ("require(any(u) and parallel", "require(parallel", "require(any(u)"),
    ("[Fraction(3 * norm, sum(", "[Fraction(2 * norm, sum(", "[Fraction(3, sum("),
    (
        "value - 10 * width * sine / norm**2 for",
        "value - 9 * width * sine / norm**2 for",
        "value - 10 * width * sine / norm for",
        "value for",
    ),
    (
        "values[0] - min(floors), min(floors[1:])",
        "values[0] - floors[1], min(floors[1:])",
        "values[0] - floors[0], min(floors)",
        "values[0] - floors[0], floors[2]",
    ),
    (
        "one = 2 * values[0] - floors[0] < second",
        "one = values[0] < second",
        "one = True",
        "one = 2 * values[0] - floors[0] <= second",
    ),
    ("require(self.gap >= gap", "require(self.gap > 0"),
    ("require(self.second <= second", "require(self.second", "require(self.second < second + 1"),
    (
        "angle is None or (one and angle >= sines[0])",
        "angle is None or angle >= sines[0]",
        "angle is None or one",
        "angle is None or (one and angle > 0)",
    ),
    (
        "self.unique is None or (self.unique and one)",
        "self.unique is None or one",
        "True",
        "self.unique is None or self.unique",
    ),
    ("gap / sines[0] if one else Fraction(0)", "gap / sines[0]", "Fraction(0)"),
    ("[self.indices.count(k) for k in range(4)]", "[self.indices.count(k) for k in (0, 2, 1, 3)]"),
    ("room = len(self.indices), self.second - value", "room = len(self.indices), self.second"),
    ("if room > 0 else", "if room >= -1 else"),
    ("(5 - 2 * times) for times, k", "1 for times, k"),
    ("24 * k - mean * times for", "24 * k for", "24 * k + mean * times for"),
    ("k * left[m[at]][j]", "k * left[j][m[at]]"),
    ("c if m[at] == j else -c", "c", "-c if m[at] == j else c"),
    (
        "for first, rank in (1, 45), (0, 80):",
        "for first, rank in [(0, 80)]:",
        "for first, rank in (1, 44), (0, 80):",
        "for first, rank in (1, 45), (0, 81):",
    ),
    ("(k.count(j) + 1), 0) for k in CUBICS", "1, 0) for k in CUBICS"),
    ("- sum(map(mul, b, d)), sum(", "+ sum(map(mul, b, d)), sum("),
    (
        "room = 4 * (isqrt(x * x + y * y)",
        "room = 5 * (isqrt(x * x + y * y)",
        "room = 4 * (isqrt(x * x)",
    ),
    (
        "12 * (max(s) + 1) ** 2 * most * size)",
        "11 * (max(s) + 1) ** 2 * most * size)",
        "12 * max(s) ** 2 * most * size)",
        "12 * (max(s) + 1) * most * size)",
        "12 * (max(s) + 1) ** 2 * most)",
    ),
    (
        "room > 0 and u * u + v * v < room**2",
        "u * u + v * v < room**2",
        "room > 0 and u * u < room**2",
        "room > 0",
        "room > 0 and u * u + v * v <= room**2",
    ),
    (
        "420 * (max([abs(x) for x, _ in P]) + 1) ** 4 * most",
        "400 * (max([abs(x) for x, _ in P]) + 1) ** 4 * most",
        "420 * max([abs(x) for x, _ in P]) ** 4 * most",
        "0",
    ),
    ("for by in (-change, change):", "for by in [-change]:", "for by in [change]:"),
    ("norm * J[i][j][0] - v[i] * along[j]", "norm * J[i][j][0]", "J[i][j][0] - v[i] * along[j]"),
    ("D[i][j] + D[j][i] + 2 * by", "2 * D[i][j] + 2 * by", "D[i][j] + D[j][i] + by"),
    ("a * d - b * b + a * f - c * c + d * f - e * e", "a * d - b * b + a * f - c * c + d * f"),
    ("a * d * f + 2 * b * c * e -", "a * d * f -"),
    (
        "(1, a + d + f, minors, last) if term]",
        "(a + d + f, minors, last) if term]",
    ),
    ('require(len(found) == 1, "an', 'require(True, "an'),
)
SIMILARITY = mutants(
    ('False): b"certreg-similarity/1', 'False): b"certreg-similarity-symmetric/1'),
    ('b"certreg-similarity-rotation/1', 'b"certreg-similarity-symmetric-rotation/1'),
    ('b"certreg-similarity-symmetric/1', 'b"certreg-similarity/1'),
    ('b"certreg-similarity-symmetric-rotation/1', 'b"certreg-similarity-symmetric/1'),
    ("PREFIXES.get((self.scale, bool(self.rotation_only))", "PREFIXES.get((self.scale, False)"),
    ('require(self.prefix, "scale', 'require(True, "scale'),
    (
        'require(delta > 0 <= mu and any(q), "delta',
        'require(delta >= 0 <= mu and any(q), "delta',
        'require(delta > 0 and any(q), "delta',
        'require(delta > 0 < mu and any(q), "delta',
        'require(delta > 0 <= mu, "delta',
    ),
    ("m, weight = self.about(m), _dyadic", "m, weight = m, _dyadic"),
    ("*[0] * 6], *m[1:]] if self.rotation_only else m", "*[0] * 6], *m[1:]]"),
    ("m, weight = self.about(m), _dyadic(m[0][0], e)", "m, weight = self.about(m), m[0][0]"),
    ('require(x > 0, f"all', 'require(x >= 0, f"all'),
    ("places = max(-e, *[", "places = max(0, *["),
    ("- 1 for k in (delta, mu)]", "- 1 for k in (delta,)]", "- 1 for k in (mu,)]"),
    ("places, 1 << places + e  #", "places, 1 << places  #"),
    ("one, unit = m[0][0] << places, 1", "one, unit = 1 << places, 1"),
    ("self.require_optimal(K, unit, d, u)\n", "\n"),
    ("self.require_pattern(pattern)\n        real", "real"),
    ("v = quadratic(K, q) * real / sum(c * c for c in q)", "v = quadratic(K, q) * real"),
    ('self._asymmetric if self.scale == "asymmetric" else', "self._asymmetric if True else"),
    ('self._asymmetric if self.scale == "asymmetric" else', "self._asymmetric if False else"),
    ("chain(*K)]) * real**2", "chain(*K)]) * real", "K[0]]) * real**2"),
    ("root_up(*(gap / weight)", "root_up(*(gap * weight)", "root_up(*(2 * gap / weight)"),
    ("prove(v, x * real, y * real, squares)", "prove(v, y * real, x * real, squares)"),
    ('require(v >= 0, "tr', 'require(v > 0, "tr', 'require(True, "tr'),
    (
        "gap, size = delta * (v + most) / x",
        "gap, size = delta * most / x",
        "gap, size = 2 * delta * v / x",
        "gap, size = delta * (v + most)",
    ),
    ("max(v * v, squares / 12)", "v * v", "squares / 12", "max(v * v, squares / 4)"),
    (
        "require(not self.gap < gap,",
        "require(not self.gap <= gap,",
        "require(not 2 * self.gap < gap,",
        "require(True,",
    ),
    (
        "self.scale_lower * x <= v and self.scale_upper * x >= most",
        "self.scale_lower * x < v and self.scale_upper * x >= most",
        "self.scale_lower * x <= v and self.scale_upper * x > most",
        "self.scale_lower * x <= v and self.scale_upper * x >= v",
        "self.scale_lower * x <= most and self.scale_upper * x >= most",
        "self.scale_lower * x <= v",
        "self.scale_upper * x >= most",
    ),
    ("share = gap * x / size if size", "share = gap / size if size", "share = gap * x / size if x"),
    ("[y - v * v / x, max(", "[y - v / x, max(", "[y - most * most / x, max("),
    (
        "max(y - most * most / x, Fraction(0))",
        "y - most * most / x",
        "max(y - v * v / x, Fraction(0))",
    ),
    ("self._place(), 2 * self.delta", "self._place(), self.delta", "self._place(), 3 * self.delta"),
    ('require(y > 0, f"all', 'require(y >= 0, f"all'),
    ("require(gap <= self.gap,", "require(gap < self.gap,", "require(True,"),
    (
        "(low <= 0 or low * low * x <= y)",
        "low * low * x <= y",
        "(low <= 0 or low * low * x < y)",
        "True",
    ),
    ("and high >= 0 and high * high", "and high * high"),
    ("high * high * x >= y\n", "high * high * x > y\n", "True\n"),
    ("(self.delta**2 / squares)", "(self.delta / squares)"),
    (
        "2 * (most * SLACK - v - self.delta)",
        "2 * (most - v - self.delta)",
        "2 * (most * SLACK - v)",
    ),
    ("SLACK - v - self.delta), Fraction(0))", "SLACK - v - self.delta), Fraction(-99))"),
    ("return [2 * (most - v), least", "return [most - v, least"),
    ('", no translation") if self.rotation_only', '", no translation") if not self.rotation_only'),
    ('over = " / s" if self.scale == "sym', 'over = " / s" if self.scale == "asym'),
    ("low, high = max(self.scale_lower, Fraction(0))", "low, high = self.scale_lower"),
    ("ends = rounded(low, 17, ROUND_FLOOR)", "ends = rounded(low, 17)"),
    ("17, ROUND_FLOOR), rounded(high, 17)", "17, ROUND_FLOOR), rounded(high, 17, ROUND_FLOOR)"),
    ("        if low:\n", "        if True:\n"),
    ("rounded(high / low - 1, 2)", "rounded(high - low, 2)"),
    ("root_up(*(weight * k * real)", "root_up(*(k * real)"),
)
TRUNCATED = mutants(
    ("HALVINGS = 64, 32, 40", "HALVINGS = 63, 32, 40"),
    (
        "require(0 < norm < 1 << 2 * BITS and self.gap > 0,",
        "require(0 <= norm < 1 << 2 * BITS and self.gap > 0,",
        "require(0 < norm and self.gap > 0,",
        "require(0 < norm <= 1 << 2 * BITS and self.gap > 0,",
        "require(0 < norm < 1 << 2 * BITS and self.gap >= 0,",
        "require(0 < norm < 1 << 2 * BITS,",
    ),
    (
        "len(self.labels) == self.n and known <=",
        "known <=",
        "len(self.labels) <= self.n and known <=",
    ),
    ('known <= {*"10?"}', "True"),
    (
        "min(-(-form_at(k, q) // norm) + 6, one)",
        "-(-form_at(k, q) // norm) + 6",
        "min(-(-form_at(k, q) // norm), one)",
        "min(-(-form_at(k, q) // norm) + 6 * one, one)",
    ),
    ("gap, angle, mu = self.gap * one,", "gap, angle, mu = self.gap * one * 2,"),
    ("survey(pairs, self.labels, cost, int(gap))\n", "\n"),
    (
        "survey(pairs, self.labels, cost, int(gap))",
        "survey(pairs, self.labels, cost, 2 * int(gap))",
    ),
    ("survey(pairs, self.labels, cost, int(gap))", "survey(pairs, self.labels, 0, int(gap))"),
    ("int(angle * mu)\n", "int(angle * mu) * 2\n", "mu\n"),
    ('if label == "1"]\n        L', 'if label != "?"]\n        L', 'if label == "0"]\n        L'),
    (
        "form_at(L, q) + (6 * self.n + mu - delta) * norm",
        "form_at(L, q) + (mu - delta) * norm",
        "form_at(L, q) + (6 * self.n + mu) * norm",
        "form_at(L, q) + (6 * self.n - delta) * norm",
        "form_at(L, q) + (6 * self.n + mu - delta)",
        "(6 * self.n + mu - delta) * norm",
    ),
    ("[[norm * k for k in row] for row in twice(L)]", "twice(L)"),
    ("[2 * mu * (q[i] * q[j])", "[mu * (q[i] * q[j])", "[4 * mu * (q[i] * q[j])"),
    ("+= k - 2 * level * (i == j)", "+= k - level * (i == j)", "+= k - 2 * level"),
    ('proved = "?" not in known and mu > 0', "proved = mu > 0", 'proved = "?" not in known'),
    ("mu > 0 and positive_definite(A)\n", "mu > 0\n"),
    ("require(angle is None or proved,", "require(True,"),
    (
        "require(not self.unique or (angle and delta <= mu),",
        "require(not self.unique or angle,",
        "require(not self.unique or delta <= mu,",
        "require(not self.unique or (angle and delta < mu),",
        "require(True,",
    ),
    ("wide = max([sum(", "wide = min([sum("),
    ("for j in (0, 4, 7, 9)]) - cost", "for j in (0, 4, 7, 9)])", "for j in (0, 4, 7)]) - cost"),
    (
        "Fraction(int(gap) + 1, wide) if",
        "Fraction(1, wide) if",
        "Fraction(int(gap) + 1, 2 * wide) if",
    ),
    ("max(cost - gap, Fraction(0)) / one", "Fraction(cost, one)", "(cost + gap) / one"),
    ("root_up(int(gap) + 1, self.n * one)", "root_up(int(gap) + 1, one)"),
    ("bound = None if angle is None else angle_bound(delta, mu)", "bound = angle_bound(delta, mu)"),
    ("worth = Worth(Fraction(self.n), ", "worth = Worth(Fraction(1), "),
    ("require(n <= PAIRS_MAX, f", "require(n < PAIRS_MAX, f", "require(True, f"),
    ("require({*weights} == {1.0}, ", "require(1.0 in weights, ", "require(True, "),
    ('require(min(bounds) > 0, "a', 'require(min(bounds) >= 0, "a', 'require(bounds[0] > 0, "a'),
    ("[*range(0, 6 * n, n), 7 * n]", "[*range(0, 6 * n, n), 6 * n]"),
    ("chain(*points[:3]), chain(*points[3:])", "chain(*points[3:]), chain(*points[:3])"),
    ("x, y, square = row[:3], row[3:6], row[6] ** 2", "x, y, square = row[:3], row[3:6], row[6]"),
    ("davenport([[i * j for j in x] for i in y])", "davenport([[i * j for j in y] for i in x])"),
    ("(u + v) * (i == j) - (4 - 2 * (i == j)) *", "(u + v) * (i == j) - (4 - 3 * (i == j)) *"),
    ("[3 * (i == j) for i, j in PRODUCTS]", "[2 * (i == j) for i, j in PRODUCTS]"),
    (
        "isqrt((12 * min(u, v) << UNITS) // square) + 1",
        "isqrt((12 * min(u, v) << UNITS) // square)",
    ),
    (
        "isqrt((12 * min(u, v) << UNITS)",
        "isqrt((11 * min(u, v) << UNITS)",
        "isqrt((12 * u << UNITS)",
    ),
    ("return [[2 * a, b, c, d], [2 * e, f, g]", "return [[a, b, c, d], [2 * e, f, g]"),
    ("[[one * (j == f) for j in range(4)] for f in range(4)], 0", "[[one, 0, 0, 0]], 0"),
    ("tests += len(left) + 16", "tests += 0"),
    ("tests <= TESTS_MAX and h > 1", "h > 1"),
    (
        "if low > (size + 1 + far) ** 2:",
        "if low > (size + 1 - far) ** 2:",
        "if low > (size + 1) ** 2:",
        "if low > far**2:",
    ),
    ('out + 1, fits and labels[k] != "1"', "out + 1, fits", 'out, fits and labels[k] != "1"'),
    ('out + 1, fits and labels[k] != "1"', 'out + 2, fits and labels[k] != "1"'),
    ("if out << UNITS > cost:", "if out << UNITS > 0:", "if out << UNITS >= cost:"),
    (
        "elif far <= size and low + 6 * norm <= (size - far) ** 2:",
        "elif low + 6 * norm <= (size - far) ** 2:",
        "elif far <= size and low + 6 * norm <= size**2:",
        "elif far <= size and low + 6 * norm <= (size + far) ** 2:",
    ),
    ('fits and labels[k] != "0"', "fits"),
    ("[*map(add, sums, form)], fits", "[*map(mul, sums, form)], fits", "sums, fits"),
    (
        "most = isqrt(low + 6 * norm) + 1 + far",
        "most = isqrt(low + 6 * norm) + 1",
        "most = isqrt(low + 6 * norm) + 1 - far",
        "most = size",
    ),
    ("(size * size << CHORD) // (most * most)", "(size << CHORD) // most", "1 << CHORD", "0"),
    ("[c + slope * a for c, a in zip(chords, form)]", "[slope * a for a in form]"),
    ("                still.append(k)\n", "                pass\n"),
    ("[c + (a << CHORD) for c, a in zip(chords, sums)]", "[c + a for c, a in zip(chords, sums)]"),
    (
        "spare, slack = cost - (out << UNITS), 6",
        "spare, slack = cost, 6",
        "spare, slack = -cost, 6",
    ),
    ("if not good and fits and {", "if not good and {"),
    ('{labels[k] for k in still} <= {"?"}', "True", "not still"),
    ("positive(A, q, f, h, spare - gap, slack)", "positive(A, q, f, h, spare - 2 * gap, slack)"),
    ("positive(A, q, f, h, spare - gap, slack)", "True"),
    ("                h //= 2\n", "                h //= 4\n"),
    ("for signs in product((-h, h), repeat=3):", "for signs in product((h,), repeat=3):"),
    ("(*signs[:f], 0, *signs[f:])", "(0, *signs)", "(*signs[:f], h, *signs[f:])"),
    (
        "boxes.append((p, f, h, out, fits, sums, still))",
        "boxes.append((p, f, h, out, True, sums, still))",
    ),
    (
        "boxes.append((p, f, h, out, fits, sums, still))",
        "boxes.append((p, f, h, 0, fits, sums, still))",
    ),
    ("k - (spare << CHORD) * (i == j) for", "k - (spare << CHORD) for", "k for"),
    ("slopes[i] += rows[i][j - i] * q[j]", "slopes[i] += rows[i][j - i] * q[i]"),
    ("* q[i] * (i < j)", "* q[i]", "* 0"),
    (
        "sum(map(abs, slopes)) - abs(slopes[f])",
        "sum(map(abs, slopes))",
        "0",
        "max(map(abs, slopes))",
    ),
    ("3 * h * (max(spare + slack, 0) << CHORD)", "3 * h * (spare + slack << CHORD)", "0"),
    ("3 * h * (max(spare + slack, 0) << CHORD)", "2 * h * (max(spare + slack, 0) << CHORD)"),
    ("3 * h * (max(spare + slack, 0) << CHORD)", "3 * h * (max(spare, 0) << CHORD)"),
    (
        "> 2 * h * (steep + curved) or positive_definite(rows)",
        ">= 2 * h * (steep + curved) or positive_definite(rows)",
        "> h * (steep + curved) or positive_definite(rows)",
        "> 2 * h * (steep + curved)",
    ),
    ('(2, bounded_pairs, "bounds', '(1, bounded_pairs, "bounds'),
)
MUTANTS = (
    tuple(mutant for group, _ in GROUPS for mutant in group)
    + SPRINGS
    + SIMILARITY
    + TRUNCATED
    + LISTS
)


def noticed(text: str, mutant: Mutant, cases: list[Case], early: Sequence[Case] = ()) -> str | None:
    """A question that a mutant of the text answers wrongly; None if it survives.

    That case goes to the front of the list: most mutants fail where others did. The early ones
    are asked before in any case: they cost nothing.
    """
    if text.count(mutant.old) != 1:
        raise ValueError(f"{mutant.says}: the text stands {text.count(mutant.old)} times")
    found = failing(text.replace(mutant.old, mutant.new), [*early, *cases])
    cases.sort(key=lambda case: case.name != found)
    return found


@cache
def _compiled(part: str) -> CodeType:
    """A part of the checker: nearly all mutants share nearly all parts."""
    return compile(part, str(FILE), "exec", annotations.compiler_flag)


def failing(text: str, cases: Sequence[Case]) -> str | None:
    """The first question that the checker with this text answers wrongly."""
    checker = ModuleType("mutated_checker")
    sys.modules[checker.__name__] = checker  # where a dataclass looks for its annotations
    try:
        for part in text.split("\n\n\n"):  # its functions, classes, groups of constants
            exec(_compiled(part), vars(checker))  # noqa: S102  (the shipped text)
    except Exception as error:  # noqa: BLE001  (any mutant)
        return f"not even loaded: {error!r}"
    finally:
        del sys.modules[checker.__name__]
    return next((case.name for case in cases if not case.passes(checker)), None)


def answers(every: int = 1) -> dict[str, str | None]:
    """By which question each mutant, or one in `every`, was noticed; None for survivors."""
    text, found = FILE.read_text(encoding="utf-8"), {}
    for group, subjects in GROUPS:
        cases = quick_cases(*subjects)
        found |= {mutant.says: noticed(text, mutant, cases) for mutant in group[::every]}
    cases = springs_cases()
    found |= {mutant.says: noticed(text, mutant, cases) for mutant in SPRINGS[::every]}
    cases = similarity_cases()
    found |= {mutant.says: noticed(text, mutant, cases) for mutant in SIMILARITY[::every]}
    cases = [*truncated_cases()]
    found |= {mutant.says: noticed(text, mutant, cases) for mutant in TRUNCATED[::every]}
    early = early_list_cases()
    cases = list_cases()[len(early) :]  # each takes 50 ms
    lists = LISTS[every - 1 :: every**2]  # the first one takes two seconds
    return found | {mutant.says: noticed(text, mutant, cases, early) for mutant in lists}


def main() -> None:
    """Print, as one JSON object, by which question each mutant was noticed."""
    sys.stdout.write(json.dumps(answers(), indent=1) + "\n")


if __name__ == "__main__":
    main()
