"""The part of docs/machine-checked-proofs.md that lists the theorems, from the .v files themselves.

    python3 derivations/coq/page.py        renews it in place

Prose is the comment that stands before a theorem; its assumptions come from assumptions.txt, which
check.py compares with what Coq prints. Standard library only.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
PAGE = HERE.parent.parent / "docs" / "machine-checked-proofs.md"
MARK = "<!-- From here on written by derivations/coq/page.py -->\n"
LETTERS = {  # as explained on the page
    "ClassicalDedekindReals.sig_forall_dec": "R1",
    "ClassicalDedekindReals.sig_not_dec": "R2",
    "FunctionalExtensionality.functional_extensionality_dep": "F",
    "Classical_Prop.classic": "C",
}
ORDER = (  # from the ground up; a file that is missing here is an error
    *("Vectors", "Quaternions", "Clouds", "Moments", "Davenport", "Extremum", "Spectral"),
    *("Equilibria", "SingularValues", "Index", "Hessian", "Stability", "Dynamics", "Ambient"),
    *("Certificate", "Basin", "Definite", "Integers", "Checker"),
)
DEFINITION = re.compile(
    r"^(?:\(\*\* (?:(?!\*\)).)*?\*\)\n)?"
    r"(?:Definition|Fixpoint|Record|Inductive) .*?\.(?=[ \n])(?: *\(\*.*?\*\))?\n",
    re.MULTILINE | re.DOTALL,
)
THEOREM = re.compile(
    r"^\(\*\* (?P<prose>(?:(?!\*\)).)*?) ?\*\)\n(?P<statement>Theorem (?P<name>\w+).*?)\nProof",
    re.MULTILINE | re.DOTALL,
)


def page(text: str) -> str:
    """The page with its list of theorems made anew."""
    return text.partition(MARK)[0] + MARK + "".join(map(section, ORDER))


def section(name: str) -> str:
    """One file: what its head says, its definitions, and each theorem in prose and in Coq."""
    text = (HERE / f"{name}.v").read_text(encoding="utf-8")
    head = re.sub(r"\n {4}", "\n", text.partition("(** ")[2].partition(" *)")[0])
    parts = [f"\n## {name}.v\n\n{head}\n"]
    defined = "".join(match[0] for match in DEFINITION.finditer(text)).strip()
    if defined:
        parts.append(f"\nDefinitions:\n\n```coq\n{defined}\n```\n")
    for match in THEOREM.finditer(text):
        prose = " ".join(match["prose"].split())
        parts.append(
            f"\n### {match['name']}\n\n{prose}\n\n```coq\n{match['statement']}\n```\n\n"
            f"Assumes: {assumed(name + '.' + match['name'])}.\n"
        )
    return "".join(parts)


def assumed(theorem: str) -> str:
    """The axioms of a theorem in the page's letters."""
    recorded = (HERE / "assumptions.txt").read_text(encoding="utf-8").splitlines()
    line = next(line for line in recorded if line.startswith(f"{theorem}: "))
    return ", ".join(LETTERS.get(axiom, axiom) for axiom in line.partition(": ")[2].split(", "))


def main() -> int:
    """Renew the page; exit code 0."""
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
