"""The part of docs/machine-checked-proofs.md that lists the theorems, from the .v files themselves.

    python3 -m derivations.coq.page        renews it in place

Standard library only.
"""

from __future__ import annotations

import re
import sys

from .theorems import HERE, ORDER, Theorem, theorems

PAGE = HERE.parent.parent / "docs" / "machine-checked-proofs.md"
MARK = "<!-- From here on written by derivations/coq/page.py -->\n"
LETTERS = {  # as explained on the page
    "ClassicalDedekindReals.sig_forall_dec": "R1",
    "ClassicalDedekindReals.sig_not_dec": "R2",
    "FunctionalExtensionality.functional_extensionality_dep": "F",
    "Classical_Prop.classic": "C",
}
DEFINITION = re.compile(
    r"^(?:\(\*\* (?:(?!\*\)).)*?\*\)\n)?"
    r"(?:Definition|Fixpoint|Record|Inductive) .*?\.(?=[ \n])(?: *\(\*.*?\*\))?\n",
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
    parts += [shown(theorem) for theorem in theorems().values() if theorem.file == name]
    return "".join(parts)


def shown(theorem: Theorem) -> str:
    """A theorem under its name: prose, statement, axioms."""
    return (
        f"\n### {theorem.name}\n\n{theorem.prose}\n\n```coq\n{theorem.statement}\n```\n\n"
        f"Assumes: {assumed(theorem)}.\n"
    )


def assumed(theorem: Theorem) -> str:
    """The axioms of a theorem in the page's letters."""
    return ", ".join(LETTERS.get(axiom, axiom) for axiom in theorem.axioms) or "nothing"


def main() -> int:
    """Renew the page; exit code 0."""
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
