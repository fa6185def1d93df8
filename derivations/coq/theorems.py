"""The theorems that the .v files state, cut out of them, with what each assumes.

Prose is the comment that stands before a theorem; its axioms come from assumptions.txt, which
check.py compares with what Coq prints. Standard library only.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

HERE = Path(__file__).resolve().parent
ORDER = (  # from the ground up; a test compares with the files that are there
    *("Vectors", "Quaternions", "Clouds", "Moments", "Inertia", "Davenport", "Extremum"),
    *("Spectral", "Equilibria", "SingularValues", "Index", "Hessian", "Stability", "Dynamics"),
    *("Ambient", "Certificate", "Basin", "Definite", "Integers", "Checker"),
)
THEOREM = re.compile(
    r"^\(\*\* (?P<prose>(?:(?!\*\)).)*?) ?\*\)\n(?P<statement>Theorem (?P<name>\w+).*?)\nProof",
    re.MULTILINE | re.DOTALL,
)
OPENING, CLOSING = "([{", ")]}"
BINDERS = ("forall", "exists", "fun", "let", "match", "if")


@dataclass(frozen=True, slots=True, kw_only=True)
class Theorem:
    """A theorem as its file states it: prose, Coq's words, and the axioms that Coq says it uses."""

    file: str
    name: str
    prose: str
    statement: str
    axioms: tuple[str, ...]

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """What stands before the outermost arrows of the statement, each on one line."""
        return _arrows(self._body)[:-1]

    @property
    def _body(self) -> str:
        words = " ".join(self.statement.split())
        return words[_outermost(words, " : ") + 3 :].removesuffix(".")


@cache
def theorems() -> dict[str, Theorem]:
    """All theorems by name, from the ground up."""
    axioms = _recorded()
    found = [
        Theorem(
            file=file,
            name=match["name"],
            prose=" ".join(match["prose"].split()),
            statement=match["statement"],
            axioms=axioms[f"{file}.{match['name']}"],
        )
        for file in ORDER
        for match in THEOREM.finditer((HERE / f"{file}.v").read_text(encoding="utf-8"))
    ]
    return {theorem.name: theorem for theorem in found}


def _recorded() -> dict[str, tuple[str, ...]]:
    lines = (HERE / "assumptions.txt").read_text(encoding="utf-8").splitlines()
    parts = (line.partition(": ") for line in lines)
    return {
        name: () if listed == "nothing" else tuple(listed.split(", ")) for name, _, listed in parts
    }


def _outermost(words: str, mark: str) -> int:
    """Where a mark first stands outside of brackets and binders; -1 if nowhere."""
    depth = 0
    for place, letter in enumerate(words):
        depth += (letter in OPENING) - (letter in CLOSING)
        if depth == 0 and words.startswith(mark, place):
            return place
        if depth == 0 and re.match(rf"({'|'.join(BINDERS)})\b", words[place:]):
            return -1  # binds all that follows
    return -1


def _arrows(words: str) -> tuple[str, ...]:
    place = _outermost(words, " -> ")
    if place < 0:
        return (words,)
    return (words[:place], *_arrows(words[place + 4 :]))
