"""The verdicts on the paper's claims: text, Markdown, JSON, a page of HTML, and their folder."""

from __future__ import annotations

import base64
import math
import os
import re
import textwrap
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg import __version__
from certreg.campaign.table import records_bytes
from certreg.errors import InvalidFileError
from certreg.io.atomic import remedy_of, write_atomically
from certreg.paper.claims import NEAR
from certreg.paper.derivation import plain
from certreg.paper.equilibrium_maps import SPRINGS_FILE, SpringCounts, spring_rows
from certreg.paper.experiments import STEP, STOP, unstable_counts
from certreg.paper.parameter_sweeps import SWEEPS_FILE, Sweep, sweep_rows
from certreg.paper.style import Drawing, written
from certreg.report.document import dumps
from certreg.report.markup import rendered

if TYPE_CHECKING:
    from certreg.paper.observations import Observations
    from certreg.paper.verdicts import CertifiedCloud, ClaimVerdict, Reproduction


REPRODUCTION_SCHEMA = "certreg-reproduction/1"
FIGURES, KINDS = "figures", ("pdf", "png")
CERTIFICATES = "counterexamples"
TERMINAL = 100  # characters
PATTERN = (0, 1, 2, 3)
CERTIFICATES_EXPLAINED = (
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
PAGE, TABLE, DOCUMENT = "verdicts.html", "verdicts.md", "verdicts.json"
SIGNS = {
    "true": "✓",
    "true under a condition": "◐",
    "false as stated": "✗",
    "not proved here": "?",
}


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
        *(("certified", certificate_words(each)) for each in claim.certified),
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


def certificate_words(cloud: CertifiedCloud) -> str:
    """What the certificates of a counterexample's cloud prove, in which files."""
    return f"{', '.join(cloud.files)}: {certified_words(cloud)}"


def certified_words(cloud: CertifiedCloud) -> str:
    """What the certificates of a counterexample's cloud prove, or why one was refused."""
    return cloud.words if cloud.verdict.proved else f"REFUSED: {cloud.verdict.words}"


def closing_text(reproduction: Reproduction) -> str:
    """How many claims have which finding, and the paper's own counts, measured."""
    findings: dict[str, int] = {}
    for claim in reproduction.claims:
        findings[claim.row.finding.value] = findings.get(claim.row.finding.value, 0) + 1
    listed = ", ".join(f"{count} {finding}" for finding, count in findings.items())
    confirmed = sum(claim.stands for claim in reproduction.claims)
    equilibria, simulations = (
        _equilibria(reproduction.observations),
        _simulations(reproduction.observations),
    )
    proved = all(claim.proof is not None for claim in reproduction.claims)
    word = (
        "are confirmed" if proved else "agree with what was measured, none was proved in this run"
    )
    return (
        f"{confirmed} of {len(reproduction.claims)} findings {word} ({listed}).\n"
        f"Four equilibria with 0, 1, 2, 3 unstable eigenvalues in {equilibria['pattern_0123']:,} "
        f"of {equilibria['runs']:,} runs; {simulations['at_optimum']:,} of "
        f"{simulations['runs']:,} simulations end at the optimum."
    )


def markdown(reproduction: Reproduction, drawings: Sequence[Drawing]) -> str:
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
    lines = [
        "# The claims of the paper, with verdicts",
        "",
        setup_words(reproduction.observations),
        "",
    ]
    lines += [_line(head), _line(["---"] * len(head))]
    for claim in reproduction.claims:
        row = claim.row
        cells = (row.number, row.claim, row.place, row.finding.value, row.holds)
        proof = proof_words(claim) or "not in this run"
        lines.append(_line((*cells, claim.evidence.words, proof, verdict_word(claim))))
    examples = [claim for claim in reproduction.claims if claim.row.counterexample is not None]
    lines += ["", "## Counterexamples", "", CERTIFICATES_EXPLAINED, ""]
    for claim in examples:
        lines.append(f"- **{claim.row.number}.** {claim.row.counterexample.words}")
        lines += [f"  - {_linked(each)}" for each in claim.certified]
    lines += ["", "## Figures", ""]
    for drawing in drawings:
        image = f"![{drawing.title}]({FIGURES}/{drawing.name}.png)"
        lines += [image, "", f"**{drawing.title}.** {_escaped(drawing.caption)}", ""]
    return "\n".join(lines)


def reproduction_document(
    reproduction: Reproduction,
    drawings: Sequence[Drawing],
    sweeps: Sequence[Sweep] = (),
    springs: Sequence[SpringCounts] = (),
) -> Document:
    """The reproduction as `certreg-reproduction/1`."""
    setup = reproduction.observations.setup
    reasons: dict[str, str] = {}
    if any(claim.proof is None for claim in reproduction.claims):
        reasons["claims.proved"] = NOT_PROVED_NOW
    if all(run.diverged for run in reproduction.observations.simulations):
        reasons["simulations"] = ALL_DIVERGED
    return {
        "schema": REPRODUCTION_SCHEMA,
        "certreg": __version__,
        "setup": {
            "points": setup.points,
            "noise": setup.noise,
            "damping": setup.damping,
            "seed": setup.seed,
            "step": STEP,
            "stop": STOP,
        },
        "confirmed": reproduction.stands,
        "claims": [_claim_fields(claim) for claim in reproduction.claims],
        "equilibria": _equilibria(reproduction.observations),
        "simulations": _simulations(reproduction.observations),
        "figures": [
            {
                "name": drawing.name,
                "title": drawing.title,
                "caption": drawing.caption,
                "files": [f"{FIGURES}/{drawing.name}.{kind}" for kind in KINDS],
            }
            for drawing in drawings
        ],
        "maps": list(sweep_rows(sweeps)),
        "springs": list(spring_rows(springs)),
        "reasons": reasons,
    }


def setup_words(observed: Observations) -> str:
    """What the instances were, in a sentence."""
    setup = observed.setup
    return (
        f"certreg {__version__}: {len(observed.equilibria):,} instances for the equilibria and "
        f"{len(observed.simulations):,} for the simulations, N = {setup.points} points, "
        f"σ = {setup.noise:g}, μ = {setup.damping:g}, explicit Euler with the step "
        f"{STEP:g}, seed {setup.seed}. The paper states neither N nor μ."
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
                "files": [f"{CERTIFICATES}/{name}" for name in cloud.files],
                "proves": cloud.words,
                "verified": cloud.verdict.proved,
            }
            for cloud in claim.certified
        ],
        "agrees": claim.evidence.agrees,
        "confirmed": claim.stands,
        "verdict": verdict_word(claim),
    }


def _equilibria(observed: Observations) -> Document:
    runs = observed.equilibria
    regular = [run.count == 4 and unstable_counts(run) == (PATTERN, PATTERN) for run in runs]
    spurious = [pose for run in runs for pose in run.poses[1:]]
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
        "half_turn_error_deg": _spread([pose.half_turn_error for pose in spurious]),
        "arccos_error_deg": _spread([abs(180.0 - pose.arccos_angle) for pose in spurious]),
    }


def _simulations(observed: Observations) -> Document:
    runs = observed.simulations
    return {
        "runs": len(runs),
        "stopped": sum(run.stopped for run in runs),
        "diverged": sum(run.diverged for run in runs),
        "at_optimum": sum(run.stopped and run.distance <= NEAR for run in runs),
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


def _linked(cloud: CertifiedCloud) -> str:
    """The words of a certified cloud, its files as links."""
    words = certificate_words(cloud)
    for name in cloud.files:
        words = words.replace(name, f"[{name}]({CERTIFICATES}/{name})", 1)
    return words


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(map(_escaped, cells)) + " |"


def _escaped(words: str) -> str:
    """Words in which Markdown sees no table, emphasis or mathematics."""
    return re.sub(r"([|*_])", r"\\\1", words)


def texts(reproduction: Reproduction) -> Iterator[str]:
    """Every claim, then the closing lines, for a terminal."""
    yield setup_words(reproduction.observations)
    for claim in reproduction.claims:
        yield "\n" + claim_text(claim)
    yield "\n" + closing_text(reproduction)


def html_page(reproduction: Reproduction, drawings: Sequence[Drawing]) -> str:
    """One file of HTML that needs no other: the verdicts, then the figures with captions."""
    whole = rendered(
        "paper/templates/verdicts.html",
        lead=closing_text(reproduction).replace("\n", " "),
        setup=setup_words(reproduction.observations),
        explained=CERTIFICATES_EXPLAINED,
        claims=[_claim(claim) for claim in reproduction.claims],
        figures=[_figure(drawing) for drawing in drawings],
    )
    return f"{whole}\n"


def make_folder(folder: Path) -> None:
    """The folder with its places for figures and certificates. Raises InvalidFileError."""
    try:
        for name in (FIGURES, CERTIFICATES):
            (folder / name).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InvalidFileError(
            f"{folder}: cannot be made a folder ({error.strerror}): {remedy_of(error)}", path=folder
        ) from error


def write_reproduction(
    reproduction: Reproduction,
    drawings: Sequence[Drawing],
    folder: str | os.PathLike[str],
    sweeps: Sequence[Sweep] = (),
    springs: Sequence[SpringCounts] = (),
) -> Path:
    """Write figures, captions, certificates and verdicts; the path of the page.

    sweeps, springs: those whose numbers are to be written, too.
    Each file is written under a temporary name and renamed. Raises InvalidFileError.
    """
    place = Path(folder)
    document = reproduction_document(reproduction, drawings, sweeps, springs)
    contents = {
        TABLE: markdown(reproduction, drawings).encode(),
        PAGE: html_page(reproduction, drawings).encode(),
        DOCUMENT: (dumps(document) + "\n").encode(),
    }
    for drawing in drawings:
        stem = f"{FIGURES}/{drawing.name}"
        contents |= {f"{stem}.{kind}": written(drawing, kind) for kind in KINDS}
        contents[f"{stem}.txt"] = f"{drawing.title}. {drawing.caption}\n".encode()
    if sweeps:
        contents[SWEEPS_FILE] = records_bytes(sweep_rows(sweeps))
    if springs:
        contents[SPRINGS_FILE] = records_bytes(spring_rows(springs))
    for claim in reproduction.claims:
        for cloud in claim.certified:
            files = cloud.files.items()
            contents |= {f"{CERTIFICATES}/{name}": content for name, content in files}
    make_folder(place)
    for name, content in contents.items():
        write_atomically(place / name, content)
    return place / PAGE


def _claim(claim: ClaimVerdict) -> dict[str, Any]:
    """What the page says of a claim."""
    row = claim.row
    return {
        "number": row.number,
        "finding": row.finding.value,
        "sign": SIGNS[row.finding.value],
        "state": verdict_word(claim),
        "stands": claim.stands,
        "words": plain(row.claim),
        "place": row.place,
        "parts": [
            ("holds", plain(row.holds)),
            ("counterexample", "" if row.counterexample is None else row.counterexample.words),
            ("measured", claim.evidence.words),
            ("proved in this run", proof_words(claim)),
        ],
        "certified": [_certified(cloud) for cloud in claim.certified],
    }


def _certified(cloud: CertifiedCloud) -> dict[str, Any]:
    """What the certificates of a cloud prove, and the files themselves."""
    files = [{"name": name, "content": _base64(content)} for name, content in cloud.files.items()]
    return {"files": files, "words": certified_words(cloud)}


def _figure(drawing: Drawing) -> dict[str, str]:
    content = _base64(written(drawing, "svg"))
    return {
        "name": drawing.name,
        "title": drawing.title,
        "caption": drawing.caption,
        "content": content,
    }


def _base64(content: bytes) -> str:
    return base64.b64encode(content).decode("ascii")
