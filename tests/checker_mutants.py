"""Mutants of the trusted checker, and who notices: `python tests/checker_mutants.py`.

Each mutant changes one place of `certreg/verify.py`, in memory only, and is asked the questions of
`checker_boundaries`. One that answers all of them as it should has survived: it is a wrong checker
that every test lets pass.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from checker_boundaries import Case, quick_cases

if TYPE_CHECKING:
    from collections.abc import Sequence

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
    ("content[-8:] * n == content[-8 * n :]", "True", "False"),
    ('== fields["digest"], "the digest', "!= '', \"the digest"),
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
    ("require(delta > 0 and", "require(delta >= 0 and", "require("),
    ("and mu >= 0 and", "and mu > 0 and", "and"),
    ("mu >= 0 and any(q)", "mu >= 0"),
    ("require(mass > 0", "require(mass >= 0"),
    (
        "unit = Fraction(2) ** e / mass",
        "unit = Fraction(2) ** e",
        "unit = Fraction(2) ** -e / mass",
    ),
    (
        "C = [[mass * m[k][j] - m[0][k] * m[0][j] for k in xyz]",
        "C = [[mass * m[k][j] for k in xyz]",
    ),
    ("trace * (i == j) - S[i][j]", "trace * (i == j)", "S[i][j]", "trace * (i == j) + S[i][j]"),
    ("    level = v + delta - mu\n", "    level = v + delta\n", "    level = v + 2 * delta - mu\n"),
    ("require(proves_level(K, unit, q, level, mu)", "require(True"),
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
    ("pattern[0] == 1 or not", "True or not"),
    ("accumulate(pattern[:-1])] if solid", "accumulate(pattern[:-1])] if True"),
    (
        "nu is None or proves_level(K, unit, q, nu, Fraction(0))",
        "nu is None or nu >= level",
        "True",
    ),
    ("K, unit, q, nu, Fraction(0)", "K, unit, q, nu, mu"),
    ("(nu is not None and", "(True or"),
    ("sdp_gap >= 2 * (nu - v)", "sdp_gap >= nu - v", "sdp_gap > 2 * (nu - v)", "sdp_gap > 0"),
    ("K, J, level / unit)", "K, J, level)", "K, J, v / unit)", "K, J, (level - delta) / unit)"),
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
    ("1 < modulus < MODULUS_MAX", "1 <= modulus < MODULUS_MAX", "1 < modulus <= MODULUS_MAX"),
    ("require(1 < modulus", "require(2 < modulus"),
    ("chart[j] * (i == k) + chart[i]", "chart[j] * (i == k) - chart[i]", "(i == k) + chart[i]"),
    ("j == k and i != j", "j == k"),
    ("require(has_full_rank(columns, modulus)", "require(True"),
    ('>= 4, "claims.at_most', '> 4, "claims.at_most', '>= 3, "claims.at_most'),
    ("require(m[0][0] > 0", "require(m[0][0] >= 0"),
)
MUTANTS = LIMITS + DATA + SUMS + ISOTROPIC + COUNT


def noticed(text: str, mutant: Mutant, cases: Sequence[Case]) -> str | None:
    """The first question that a mutant of the text answers wrongly; None if it survives."""
    if text.count(mutant.old) != 1:
        raise ValueError(f"{mutant.says}: the text stands {text.count(mutant.old)} times")
    return failing(text.replace(mutant.old, mutant.new), cases)


def failing(text: str, cases: Sequence[Case]) -> str | None:
    """The first question that the checker with this text answers wrongly."""
    checker = ModuleType("mutated_checker")
    sys.modules[checker.__name__] = checker  # where a dataclass looks for its annotations
    try:
        exec(compile(text, str(FILE), "exec"), vars(checker))  # noqa: S102  (the shipped text)
    except Exception as error:  # noqa: BLE001  (any mutant)
        return f"not even loaded: {error!r}"
    finally:
        del sys.modules[checker.__name__]
    return next((case.name for case in cases if not case.passes(checker)), None)


def survivors() -> list[str]:
    """The mutants that no question of a quick case tells from the shipped checker."""
    text, cases = FILE.read_text(encoding="utf-8"), quick_cases()
    return [mutant.says for mutant in MUTANTS if noticed(text, mutant, cases) is None]


def main() -> None:
    """Print, as one JSON object, by which question each mutant was noticed."""
    text, cases = FILE.read_text(encoding="utf-8"), quick_cases()
    found = {mutant.says: noticed(text, mutant, cases) for mutant in MUTANTS}
    sys.stdout.write(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
