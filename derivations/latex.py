"""The executed claims as one LaTeX document."""

from __future__ import annotations

import re
from collections.abc import Sequence

import sympy

from .kernel import ClaimOutcome
from .rings import is_short
from .steps import Step

_TOP = r"""\documentclass{article}
\usepackage[utf8]{inputenc}
\usepackage[T1]{fontenc}
\usepackage{amsmath,amssymb}
\title{The registration dynamics, derived}
\date{}
\begin{document}
\maketitle
"""
_MATH = re.compile(r"(\$\$.*?\$\$|\$.*?\$)", re.DOTALL)
_ESCAPES = {"\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "#": r"\#", "_": r"\_"}
_ESCAPES |= {"{": r"\{", "}": r"\}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}


def document(outcomes: Sequence[ClaimOutcome]) -> str:
    """A LaTeX document: each claim with its statement, its checked steps, what must fail."""
    return _TOP + "".join(map(_claim, outcomes)) + "\\end{document}\n"


def _claim(outcome: ClaimOutcome) -> str:
    claim = outcome.claim
    steps = "".join(map(_step, outcome.steps))
    used = f"Used, not proved here: {text(' '.join(claim.standard))}\n\n" if claim.standard else ""
    controls = "".join(
        f"\\item {text(control.name)}: {text(control.words)}\n" for control in outcome.controls
    )
    said = "".join(f"{heading}: {text(' '.join(words))}\n\n" for heading, words in claim.premises)
    return (
        f"\n\\section{{{text(claim.title)}}}\n{text(claim.statement)}\n\n"
        f"{said}{used}"
        f"Source: {text(claim.source)}\n"
        f"\\begin{{enumerate}}\n{steps}\\end{{enumerate}}\n"
        f"Refuted by the same proof, and false:\n\\begin{{itemize}}\n{controls}\\end{{itemize}}\n"
        f"Not claimed: {text(claim.not_claimed)}\n"
    )


def _step(step: Step) -> str:
    checked = f"{step.kind.value}: {step.verdict.words}"
    return f"\\item {text(step.says)} \\emph{{({text(checked)})}} {compared(step)}\n"


def compared(step: Step) -> str:
    """The equation that a step compared, from the expressions themselves, where one is short.

    Of a vector or matrix the first entry with two sides that differ as they are written.
    """
    sides = step.asserted.sides if step.asserted is not None else ()
    for k, (left, right) in enumerate(sides):
        if left != right and is_short(left) and is_short(right):
            place = f" (entry {k + 1} of {len(sides)})" if len(sides) > 1 else ""
            return f"${sympy.latex(left)} = {sympy.latex(right)}${place}"
    return ""


def text(markdown: str) -> str:
    """Markdown with formulas as LaTeX: formulas stay, the rest is escaped, code and bold kept."""
    parts = _MATH.split(markdown)
    return "".join(part if k % 2 else _prose(part) for k, part in enumerate(parts))


def _prose(words: str) -> str:
    escaped = "".join(_ESCAPES.get(character, character) for character in words)
    escaped = re.sub(r"`([^`]*)`", r"\\texttt{\1}", escaped)
    return re.sub(r"\*\*([^*]*)\*\*", r"\\textbf{\1}", escaped)
