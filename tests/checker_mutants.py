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
    ("len(text) <= FILE_MAX", "len(text) < FILE_MAX"),
    ("nodes <= NODES_MAX", "nodes < NODES_MAX"),
    ('(b",", b"[", b"{")', '(b",", b"[")', '(b",", b"{")', '(b"[", b"{")'),
    ("len(digits) <= DIGITS_MAX", "len(digits) < DIGITS_MAX", "True"),
    ("abs(exponent) <= EXPONENT_MAX", "exponent <= EXPONENT_MAX", "abs(exponent) < EXPONENT_MAX"),
    ("len(pairs) == len(dict(pairs))", "True"),
    ("type(value) is kind", "isinstance(value, kind)"),
    ("MODULUS_MAX = 2**64", "MODULUS_MAX = 2**63", "MODULUS_MAX = 2**65"),
    ("file.read(FILE_MAX + 1)", "file.read(FILE_MAX)"),
    ("UNIT = 3 * (1073 + 53)", "UNIT = 3 * (1073 + 52) // 4"),
)
DATA = mutants(
    ("1 <= n < 2**40", "0 <= n < 2**40", "1 < n < 2**40", "1 <= n <= 2**40", "1 <= n < 2**39"),
    ("n <= INLINE_MAX and", "n < INLINE_MAX and", ""),
    ("content.startswith(head) and", ""),
    ("and text.endswith(last)", ""),
    ("len(part) for part in parts", "len(part) for part in parts[:2]"),
    ("content.startswith(given)", "True", "content.startswith(given[:-8])"),
    ("bytes(doubles[-8:]) * n == doubles[-8 * n :]", "True", "False"),
    ('digest == certificate.digest, "the digest', 'digest, "the digest'),
    ("min(w) >= 0", "min(w) > 0", "True"),
    ("all(map(isfinite, values))", "True"),
    ("1 << 63 not in bits", "True", "1 << 63 not in bits[1:]"),
    ("sum(map(mul, weighted, a[j]))", "sum(map(mul, left, a[j]))"),
    ("UNIT + g + places[i] + places[j]", "UNIT + g + places[j]", "UNIT + places[i] + places[j]"),
    ("6 * n + start", "6 * n"),
    ("3 * (n + start)", "3 * n + start"),
    ("min((e for k, e in split if k), default=0)", "max((e for k, e in split if k), default=0)"),
)
SUMS = mutants(
    (
        "z = [C[2][1] - C[1][2], C[0][2] - C[2][0], C[1][0] - C[0][1]]",
        "z = [C[1][2] - C[2][1], C[2][0] - C[0][2], C[0][1] - C[1][0]]",
    ),
    ("C[i][j] + C[j][i] - trace", "C[i][j] + C[j][i] + trace", "C[i][j] - C[j][i] - trace"),
    ("if row[k] <= 0", "if row[k] < 0", "if row[k] == 0"),
    ("below[j] * row[k] - below[k] * row[j]", "below[j] * row[k] + below[k] * row[j]"),
    ("// previous", "// 1 // (previous or 1) ** 2"),
    ("int(entry * common) for entry", "int(entry) for entry"),
)
ISOTROPIC = mutants(
    ("Fraction(mu * a * b, square)", "Fraction(2 * mu * a * b, square)", "Fraction(mu, square)"),
    ("rows[i][j] - K[i][j]", "rows[i][j] + K[i][j]", "-K[i][j]"),
    ("diagonal = level / unit", "diagonal = level * unit", "diagonal = level"),
    ("Fraction(_form(J, w), 4)", "Fraction(_form(J, w), 8)", "Fraction(_form(J, w), 3)", "0"),
    (
        "_power(exponent) ** 2",
        "_power(exponent)",
        "_power(exponent - 1) ** 2",
        "_power(-exponent) ** 2",
        "_power(0) ** 2",
    ),
    ("return any(p) and", "return"),
    ("- spin > level", "- spin >= level", "+ spin > level"),
    ("- 27 * e3**2 != 0", "- 26 * e3**2 != 0", "+ 27 * e3**2 != 0"),
    ("e1**2 * e2**2 - 4 * e2**3", "e1**2 * e2**2 + 4 * e2**3"),
    ("18 * e1 * e2 * e3", "17 * e1 * e2 * e3"),
    ("if e2 == 0", "if D == 0"),
    ("[2, 2] if e1 else [4]", "[2, 2]", "[4]"),
    ("- 9 * e1 * e2 + 27 * e3", "- 9 * e1 * e2 + 9 * e3", "+ 9 * e1 * e2 + 27 * e3"),
    ("[1, 3] if D > 0 else [3, 1]", "[1, 3]", "[1, 3] if D < 0 else [3, 1]"),
    ("[1, 2, 1] if s < 0", "[1, 2, 1] if s > 0", "[1, 2, 1] if s <= 0 or D < 0"),
    ("else [1, 1, 2] if D > 0", "else [1, 1, 2] if D < 0", "else [1, 1, 2] if True"),
    ("good = self.delta > 0 and", "good = self.delta >= 0 and", "good ="),
    ("and self.mu >= 0 and", "and self.mu > 0 and", "and"),
    ("self.mu >= 0 and any(self.pose)", "self.mu >= 0"),
    ("require(mass > 0", "require(mass >= 0"),
    ("Fraction(2) ** sums.e / mass", "Fraction(2) ** sums.e", "Fraction(2) ** -sums.e / mass"),
    ("m[0][0] * m[j][k] - m[0][j] * m[0][k]", "m[0][0] * m[j][k]", "m[j][k]"),
    ("m[0][0] * m[min(j, k)][max(j, k)] -", "m[min(j, k)][max(j, k)] -"),
    ("max(j, k)] - m[0][j] * m[0][k]", "max(j, k)]", "max(j, k)] + m[0][j] * m[0][k]"),
    ("trace * (i == j) - S[i][j]", "trace * (i == j)", "S[i][j]", "trace * (i == j) + S[i][j]"),
    (
        "level = v + self.delta - self.mu\n",
        "level = v + self.delta\n",
        "level = v + 2 * self.delta - self.mu\n",
        "level = v + self.delta / 2 - self.mu\n",
    ),
    ('require(optimal, "', 'require(True, "'),
    ("self._require_bounds()\n", "\n"),
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
        "(mu > 0 and sin2 * mu >= delta)",
        "mu > 0",
        "(mu > 0 and sin2 * mu > delta)",
        "(mu > 0 and 2 * sin2 * mu >= delta)",
    ),
    ("true[0] == 1 or not", "True or not"),
    ("accumulate(true[:-1])] if solid", "accumulate(true[:-1])] if True"),
    (
        "nu is None or proves_level(K, unit, self.pose, nu, Fraction(0))",
        "nu is None or nu >= level",
        "True",
        "nu is None or proves_level(K, unit, self.pose, nu, self.mu)",
    ),
    ("(nu is not None and", "(True or"),
    ("gap >= 2 * (nu - v))", "gap >= nu - v)", "gap > 2 * (nu - v))", "gap > 0)"),
    (
        "K, J, level / unit, p, w)",
        "K, J, level, p, w)",
        "K, J, v / unit, p, w)",
        "K, J, (level - self.delta) / unit, p, w)",
    ),
    ("inside = solid and p and w and", "inside = solid and (not p or not w) or"),
    ('require(inside, "', 'require(inside or True, "'),
    ("        if self.basin:\n            p, w", "        if not self.basin:\n            p, w"),
    ("if 2 * delta <= mu", "if delta <= mu", "if 2 * delta < mu", "if 2 * delta <= mu * 2"),
    ("delta / (mu - delta), 20", "delta / mu, 20", "delta / (mu + delta), 20"),
    ('Fraction("114.591559027")', 'Fraction("57.2957795")'),
    ("rounded_up(2 * delta, 2)", "rounded_up(delta, 2)"),
    ("rounding=ROUND_CEILING", "rounding='ROUND_FLOOR'", "rounding='ROUND_HALF_EVEN'"),
)
COUNT = mutants(
    ("(1 if i == 0 else -1)", "1", "-1"),
    ("A[i - 1][j - 1] += 2", "A[i - 1][j - 1] += 1"),
    ("+= 2 * (i != j)", "+= 2"),
    ("A[b][a], A[a][b] = 2, -2", "A[b][a], A[a][b] = -2, 2", "A[b][a], A[a][b] = 2, 2"),
    ("product[i][j] - product[j][i]", "product[i][j] + product[j][i]", "product[i][j]"),
    ("gcd(row[k], modulus) == 1", "row[k] != 0", "gcd(row[k], modulus) >= 1"),
    ("return False\n        rows.remove", "return True\n        rows.remove"),
    ("a - factor * b", "a + factor * b"),
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
    ("require(sums.m[0][0] > 0", "require(sums.m[0][0] >= 0"),
)
FORM = mutants(
    ("needed <= set(part) <= set(known)", "needed <= set(part)", "set(part) <= set(known)"),
    ("absent = name != place and", "absent ="),
    ("not a {FORMAT} of a known kind", "no {FORMAT}"),
    ('_is(dict, document["about"]) and kind', "kind"),
    ('known and document["format"] == FORMAT', "known", 'document["format"] == FORMAT'),
    ("_is(kind, value) or (null and value is None)", "value is not None or null", "True"),
    ("null and value is None", "value is None", "False"),
    ("len(found) in lengths and", ""),
    ("and all(_is(int, each) for each in found)", ""),
    ("found[0] * _power(found[1])", "found[1] * _power(found[0])", "found[0] / _power(found[1])"),
    ('entry(bool, claims, "unique")', 'entry(bool, claims, "unique", null=True)'),
    ('entry(bool, claims, "basin", null=True)', 'entry(bool, claims, "basin")', "None"),
    ('integers(claims, "pattern", range(5))', 'integers(claims, "pattern", range(6))'),
    ('"unstable", range(5), null=True', '"unstable", range(6), null=True', '"unstable", range(5)'),
    ('gap=dyadic(claims, "gap")', 'gap=dyadic(optimality, "delta") * 2'),
    ('"sdp_gap", null=True', '"sdp_gap"'),
    ('"sin2_half_angle", null=True', '"sin2_half_angle"'),
    ('"sdp?": "nu"', '"sdp": "nu"', '"sdp?": "nu?"'),
    ('"basin?": "ang', '"basin": "ang'),
    ('integers(whole, "pose")', 'integers(whole, "pose", null=True)'),
    ('integers(state, "quaternion", null=True)', 'integers(state, "quaternion")'),
    ("for k in (IsotropicStatement, CountStatement)", "for k in (IsotropicStatement,)"),
)
# Beside each the subjects whose questions notice most of its mutants: these are asked first.
GROUPS = (
    (LIMITS, ("form", "data")),
    (DATA, ("data",)),
    (FORM, ("form",)),
    (SUMS + ISOTROPIC, ("optimality", "claims", "words", "pattern", "basin")),
    (COUNT, ("count",)),
)
MUTANTS = tuple(mutant for group, _ in GROUPS for mutant in group)


def noticed(text: str, mutant: Mutant, cases: list[Case]) -> str | None:
    """A question that a mutant of the text answers wrongly; None if it survives.

    That case goes to the front of the list: most mutants fail where others did.
    """
    if text.count(mutant.old) != 1:
        raise ValueError(f"{mutant.says}: the text stands {text.count(mutant.old)} times")
    found = failing(text.replace(mutant.old, mutant.new), cases)
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


def answers() -> dict[str, str | None]:
    """By which question each mutant was noticed, None for survivors."""
    text, found = FILE.read_text(encoding="utf-8"), {}
    for group, subjects in GROUPS:
        cases = quick_cases(*subjects)
        found |= {mutant.says: noticed(text, mutant, cases) for mutant in group}
    return found


def main() -> None:
    """Print, as one JSON object, by which question each mutant was noticed."""
    sys.stdout.write(json.dumps(answers(), indent=1) + "\n")


if __name__ == "__main__":
    main()
