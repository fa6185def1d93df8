"""The verdicts on the paper's claims as text, as Markdown and as a JSON document."""

from __future__ import annotations

import math
import re
import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg import __version__
from certreg.paper.map_tables import rows
from certreg.paper.statics import unstable_counts
from certreg.report import plain

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from certreg.paper.exhibits import Exhibit
    from certreg.paper.maps import Map
    from certreg.paper.observations import Observations
    from certreg.paper.style import Drawing
    from certreg.paper.verdicts import ClaimVerdict, Reproduction

REPRODUCTION_SCHEMA = "certreg-reproduction/1"
FIGURES, KINDS = "figures", ("pdf", "png")
CERTIFICATES = "counterexamples"
TERMINAL = 100  # characters
PATTERN = (0, 1, 2, 3)
EXHIBITS_TOLD = (
    "Each cloud of a counterexample has a certificate of its optimum and of the pattern of its "
    "equilibria (the multiplicities of the eigenvalues), and where these are four one of at most "
    "four. Where the "
    "claim is about the motion (3, 4a, 12, 13b, 15) the certificate tells which pose is right; the "
    "refutation is computed in fractions. Anyone can check a certificate: `certreg verify FILE`, "
    "or `python verify.py FILE`, one file of standard Python."
)
MEASURED_ONLY = "measured, not proved in this run"
NOT_PROVED_NOW = "the proofs were left out: `certreg derive` runs them"

ALL_DIVERGED = "every simulation went beyond the doubles: the step is too large for the damping"

Document = dict[str, Any]


def verdict_word(claim: ClaimVerdict) -> str:
    """What became of a claim's finding, which may be that the claim is false."""
    if not claim.stands:
        return "finding NOT CONFIRMED"
    return f"finding {MEASURED_ONLY}" if claim.proof is None else "finding confirmed"


def claim_text(claim: ClaimVerdict) -> str:
    """A claim for a terminal: number, finding and verdict, then proof and measurement."""
    row = claim.row
    lines = [f"{row.number:>4}  {row.finding.value.upper()} ({verdict_word(claim)})"]
    parts = (
        ("claim", plain(row.claim)),
        ("holds", "" if row.counterexample is None else plain(row.holds)),
        ("proof", proof_words(claim)),
        ("measured", claim.evidence.words),
        *(("certified", exhibit_words(each)) for each in claim.exhibits),
    )
    for name, words in parts:
        if words:
            head = f"      {name:9} "
            lines += textwrap.wrap(words, TERMINAL, initial_indent=head, subsequent_indent=" " * 16)
    return "\n".join(lines)


def proof_words(claim: ClaimVerdict) -> str:
    """What was proved of a finding in this run; empty if that was left out."""
    if claim.proof is None:
        return ""
    if not claim.proof.proved:
        return claim.proof.words
    recomputed = "" if claim.row.counterexample is None else "; counterexample, in fractions"
    return ", ".join(claim.row.because) + recomputed


def exhibit_words(exhibit: Exhibit) -> str:
    """What the certificates of a counterexample's cloud prove, in which files."""
    proved = exhibit.words if exhibit.verdict.proved else f"REFUSED: {exhibit.verdict.words}"
    return f"{', '.join(exhibit.files)}: {proved}"


def closing_text(made: Reproduction) -> str:
    """How many claims have which finding, and the paper's own counts, measured."""
    findings: dict[str, int] = {}
    for claim in made.claims:
        findings[claim.row.finding.value] = findings.get(claim.row.finding.value, 0) + 1
    told = ", ".join(f"{count} {finding}" for finding, count in findings.items())
    confirmed = sum(claim.stands for claim in made.claims)
    resting, moving = _equilibria(made.observations), _simulations(made.observations)
    proved = all(claim.proof is not None for claim in made.claims)
    word = (
        "are confirmed" if proved else "agree with what was measured, none was proved in this run"
    )
    return (
        f"{confirmed} of {len(made.claims)} findings {word} ({told}).\n"
        f"Four equilibria with 0, 1, 2, 3 unstable eigenvalues in {resting['pattern_0123']:,} of "
        f"{resting['runs']:,} runs; {moving['at_optimum']:,} of {moving['runs']:,} simulations end "
        "at the optimum."
    )


def markdown(made: Reproduction, drawn: Sequence[Drawing]) -> str:
    """The verdicts as a Markdown table, then the figures."""
    head = (
        "",
        "The paper's claim",
        "Where",
        "Finding",
        "What holds",
        "Measured",
        "Proof",
        "Verdict",
    )
    lines = ["# The claims of the paper, with verdicts", "", setup_words(made.observations), ""]
    lines += [_line(head), _line(["---"] * len(head))]
    for claim in made.claims:
        row = claim.row
        cells = (row.number, row.claim, row.place, row.finding.value, row.holds)
        proof = proof_words(claim) or "not in this run"
        lines.append(_line((*cells, claim.evidence.words, proof, verdict_word(claim))))
    examples = [claim for claim in made.claims if claim.row.counterexample is not None]
    lines += ["", "## Counterexamples", "", EXHIBITS_TOLD, ""]
    for claim in examples:
        lines.append(f"- **{claim.row.number}.** {claim.row.counterexample.words}")
        lines += [f"  - {_linked(each)}" for each in claim.exhibits]
    lines += ["", "## Figures", ""]
    for drawing in drawn:
        image = f"![{drawing.title}]({FIGURES}/{drawing.name}.png)"
        lines += [image, "", f"**{drawing.title}.** {_escaped(drawing.caption)}", ""]
    return "\n".join(lines)


def reproduction_document(
    made: Reproduction, drawn: Sequence[Drawing], found: Sequence[Map] = ()
) -> Document:
    """The reproduction as `certreg-reproduction/1`."""
    setup = made.observations.setup
    reasons: dict[str, str] = {}
    if any(claim.proof is None for claim in made.claims):
        reasons["claims.proved"] = NOT_PROVED_NOW
    if all(run.diverged for run in made.observations.simulations):
        reasons["simulations"] = ALL_DIVERGED
    return {
        "schema": REPRODUCTION_SCHEMA,
        "certreg": __version__,
        "setup": {
            "points": setup.points,
            "noise": setup.noise,
            "damping": setup.damping,
            "seed": setup.seed,
            "step": setup.settings.step,
            "stop": setup.settings.stop,
        },
        "confirmed": made.stands,
        "claims": [_claim_fields(claim) for claim in made.claims],
        "equilibria": _equilibria(made.observations),
        "simulations": _simulations(made.observations),
        "figures": [
            {
                "name": drawing.name,
                "title": drawing.title,
                "caption": drawing.caption,
                "files": [f"{FIGURES}/{drawing.name}.{kind}" for kind in KINDS],
            }
            for drawing in drawn
        ],
        "maps": list(rows(found)),
        "reasons": reasons,
    }


def setup_words(seen: Observations) -> str:
    """What the instances were, in a sentence."""
    setup = seen.setup
    return (
        f"certreg {__version__}: {len(seen.equilibria):,} instances for the equilibria and "
        f"{len(seen.simulations):,} for the simulations, N = {setup.points} points, "
        f"σ = {setup.noise:g}, μ = {setup.damping:g}, explicit Euler with the step "
        f"{setup.settings.step:g}, seed {setup.seed}. The paper states neither N nor μ."
    )


def _claim_fields(claim: ClaimVerdict) -> Document:
    row = claim.row
    return {
        "number": row.number,
        "claim": row.claim,
        "place": row.place,
        "finding": row.finding.value,
        "holds": row.holds,
        "counterexample": None if row.counterexample is None else row.counterexample.words,
        "proofs": list(row.because),
        "proved": None if claim.proof is None else claim.proof.proved,
        "measured": claim.evidence.words,
        "certificates": [
            {
                "files": [f"{CERTIFICATES}/{name}" for name in exhibit.files],
                "proves": exhibit.words,
                "verified": exhibit.verdict.proved,
            }
            for exhibit in claim.exhibits
        ],
        "agrees": claim.evidence.agrees,
        "confirmed": claim.stands,
        "verdict": verdict_word(claim),
    }


def _equilibria(seen: Observations) -> Document:
    runs = seen.equilibria
    regular = [run.count == 4 and unstable_counts(run) == (PATTERN, PATTERN) for run in runs]
    spurious = [rest for run in runs for rest in run.rests[1:]]
    return {
        "runs": len(runs),
        "four": sum(run.count == 4 for run in runs),
        "unique_optimum": sum(run.unique for run in runs),
        "pattern_0123": sum(regular),
        "exceptions": [
            {"run": k, "count": run.count, "unstable": list(unstable_counts(run)[0])}
            for k, (run, normal) in enumerate(zip(runs, regular, strict=True))
            if not normal
        ],
        "half_turn_error_deg": _spread([rest.half_turn_error for rest in spurious]),
        "arccos_error_deg": _spread([abs(180.0 - rest.arccos_angle) for rest in spurious]),
    }


def _simulations(seen: Observations) -> Document:
    runs, near = seen.simulations, seen.setup.settings.near
    return {
        "runs": len(runs),
        "stopped": sum(run.stopped for run in runs),
        "diverged": sum(run.diverged for run in runs),
        "at_optimum": sum(run.stopped and run.distance <= near for run in runs),
        "energy_rose_in_first_step": sum(run.first_rise > 0.0 for run in runs),
        "steps": _spread([run.steps for run in runs]),
        "closed_form_error_deg": _spread([run.closed_form_error for run in runs]),
        "simulation_error_deg": _spread([run.error for run in runs]),
        "simulation_to_closed_form_deg": _spread([run.distance for run in runs]),
    }


def _spread(values: Sequence[float]) -> Document:
    """The least, middle and largest of the numbers that are some; null if there are none."""
    numbers = [value for value in values if not math.isnan(value)]
    if not numbers:
        return dict.fromkeys(("min", "median", "max"))
    return {"min": min(numbers), "median": float(np.median(numbers)), "max": max(numbers)}


def _linked(exhibit: Exhibit) -> str:
    """The words of an exhibit, its files as links."""
    words = exhibit_words(exhibit)
    for name in exhibit.files:
        words = words.replace(name, f"[{name}]({CERTIFICATES}/{name})", 1)
    return words


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(map(_escaped, cells)) + " |"


def _escaped(words: str) -> str:
    """Words in which Markdown sees no table, emphasis or mathematics."""
    return re.sub(r"([|*_])", r"\\\1", words)


def texts(made: Reproduction) -> Iterator[str]:
    """Every claim, then the closing lines, for a terminal."""
    yield setup_words(made.observations)
    for claim in made.claims:
        yield "\n" + claim_text(claim)
    yield "\n" + closing_text(made)
