"""The verdicts and the figures as one page of HTML, and the folder that holds everything."""

from __future__ import annotations

import base64
import re
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from certreg.errors import InvalidFileError
from certreg.io import write_atomically
from certreg.paper.documents import (
    CERTIFICATES,
    CERTIFICATES_EXPLAINED,
    FIGURES,
    KINDS,
    certificate_words,
    closing_text,
    markdown,
    proof_words,
    reproduction_document,
    setup_words,
    verdict_word,
)
from certreg.paper.parameter_sweeps import SWEEPS_FILE, sweep_table
from certreg.paper.style import written
from certreg.paper.terminal import plain
from certreg.report import dumps

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from certreg.paper.counterexamples import CertifiedCloud
    from certreg.paper.parameter_sweeps import Sweep
    from certreg.paper.style import Drawing
    from certreg.paper.verdicts import ClaimVerdict, Reproduction

PAGE, TABLE, DOCUMENT = "verdicts.html", "verdicts.md", "verdicts.json"
SIGNS = {
    "true": "✓",
    "true under a condition": "◐",
    "false as stated": "✗",
    "not proved here": "?",
}
STYLE = """
:root { color-scheme: light; }
body { font: 16px/1.55 system-ui, sans-serif; color: #1c1c1c; background: #fff;
  max-width: 68rem; margin: 2.5rem auto; padding: 0 1.2rem; }
h1 { font-size: 1.7rem; line-height: 1.25; margin: 0 0 .6rem; }
h2 { font-size: 1.25rem; margin: 2.6rem 0 .8rem; }
.lead { max-width: 46rem; }
.setup { color: #555; max-width: 46rem; font-size: .92rem; }
article { border-top: 1px solid #d8d8d8; padding: .9rem 0 1rem; display: grid;
  grid-template-columns: 14.5rem 1fr; gap: .2rem 1.4rem; }
article > header { grid-row: span 9; }
.number { font-weight: 700; margin-right: .5rem; }
.finding { display: inline-block; font-size: .86rem; padding: .1rem .55rem; border: 1px solid;
  border-radius: 1rem; white-space: nowrap; }
.true { color: #00507a; background: #e8f2f9; }
.true-under-a-condition { color: #7a4a00; background: #fdf3df; }
.false-as-stated { color: #9c3b00; background: #fdeae0; }
.not-proved-here { color: #444; background: #eee; }
.state { font-size: .86rem; margin: .45rem 0 0; }
.failed { color: #fff; background: #9c1c00; padding: .1rem .5rem; border-radius: .3rem; }
.claim { font-weight: 600; margin: 0; }
article p { margin: .25rem 0 0; max-width: 48rem; }
.label { color: #555; font-size: .86rem; }
.place { color: #555; font-size: .9rem; }
figure { margin: 1.6rem 0 2.4rem; break-inside: avoid; }
figure img { width: 100%; max-width: 58rem; height: auto; display: block; }
figcaption { max-width: 48rem; font-size: .94rem; margin-top: .5rem; }
code { font-size: .88em; }
@media (max-width: 46rem) { article { display: block; } article > header { margin-bottom: .4rem; } }
@media print { body { font-size: 11pt; margin: 0; max-width: none; }
  article { break-inside: avoid; } }
"""


def html_page(reproduction: Reproduction, drawings: Sequence[Drawing]) -> str:
    """One file of HTML that needs no other: the verdicts, then the figures with captions."""
    lead = escape(closing_text(reproduction)).replace("\n", " ")
    claims = "\n".join(_article(claim) for claim in reproduction.claims)
    explained = re.sub("`([^`]*)`", r"<code>\1</code>", escape(CERTIFICATES_EXPLAINED))
    figures = "\n".join(_figure(number, drawing) for number, drawing in enumerate(drawings, 1))
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>The claims of the paper, with verdicts</title>
<style>{STYLE}</style>
</head>
<body>
<h1>A Dynamical Perspective on Point Cloud Registration: its claims and experiments, checked</h1>
<p class="lead">{lead}</p>
<p class="setup">{escape(setup_words(reproduction.observations))}</p>
<h2>Claims</h2>
<p class="lead">Each claim is true, or true under a condition that the paper does not state, or
false as stated; or neither it nor its contrary is proved here. The finding rests on proofs; what
was measured in this run stands beside them.
{explained}</p>
{claims}
<h2>Figures</h2>
{figures}
</body>
</html>
"""


def make_folder(folder: Path) -> None:
    """The folder with its places for figures and certificates. Raises InvalidFileError."""
    try:
        for name in (FIGURES, CERTIFICATES):
            (folder / name).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"{folder}: cannot be made a folder ({error.strerror}): choose another place"
        raise InvalidFileError(message, path=folder) from error


def write_reproduction(
    reproduction: Reproduction,
    drawings: Sequence[Drawing],
    folder: str | os.PathLike[str],
    sweeps: Sequence[Sweep] = (),
) -> Path:
    """Write figures, captions, certificates and verdicts; the path of the page.

    sweeps: those whose numbers are to be written, too.
    Each file is written under a temporary name and renamed. Raises InvalidFileError.
    """
    place = Path(folder)
    contents = {
        TABLE: markdown(reproduction, drawings).encode(),
        PAGE: html_page(reproduction, drawings).encode(),
        DOCUMENT: (dumps(reproduction_document(reproduction, drawings, sweeps)) + "\n").encode(),
    }
    for drawing in drawings:
        stem = f"{FIGURES}/{drawing.name}"
        contents |= {f"{stem}.{kind}": written(drawing, kind) for kind in KINDS}
        contents[f"{stem}.txt"] = f"{drawing.title}. {drawing.caption}\n".encode()
    if sweeps:
        contents[SWEEPS_FILE] = sweep_table(sweeps)
    for claim in reproduction.claims:
        for cloud in claim.certified:
            files = cloud.files.items()
            contents |= {f"{CERTIFICATES}/{name}": content for name, content in files}
    make_folder(place)
    for name, content in contents.items():
        write_atomically(place / name, content)
    return place / PAGE


def _article(claim: ClaimVerdict) -> str:
    row = claim.row
    finding = row.finding.value
    state = verdict_word(claim)
    shown = state if claim.stands else f'<strong class="failed">{state}</strong>'
    parts = [
        ("holds", plain(row.holds)),
        ("counterexample", "" if row.counterexample is None else row.counterexample.words),
        ("measured", claim.evidence.words),
        ("proved in this run", proof_words(claim)),
    ]
    lines = [
        f'<p><span class="label">{name}:</span> {escape(words)}</p>'
        for name, words in parts
        if words
    ]
    lines += [f'<p><span class="label">certified:</span> {_linked(e)}</p>' for e in claim.certified]
    return f"""<article id="claim-{row.number}">
<header><span class="number">{row.number}</span><span class="finding {finding.replace(" ", "-")}">\
{SIGNS[finding]} {finding}</span><p class="state">{shown}</p></header>
<p class="claim">{escape(plain(row.claim))}</p>
<p class="place">{escape(row.place)}</p>
{"".join(lines)}
</article>"""


def _linked(cloud: CertifiedCloud) -> str:
    """The words of a certified cloud, its files as links that hold them."""
    words = escape(certificate_words(cloud))
    for name, content in cloud.files.items():
        data = f"data:application/json;base64,{base64.b64encode(content).decode()}"
        words = words.replace(name, f'<a download="{name}" href="{data}">{name}</a>', 1)
    return words


def _figure(number: int, drawing: Drawing) -> str:
    data = base64.b64encode(written(drawing, "svg")).decode()
    title, caption = escape(drawing.title), escape(drawing.caption)
    return f"""<figure id="{drawing.name}">
<img src="data:image/svg+xml;base64,{data}" alt="{title}">
<figcaption><strong>Figure {number}. {title}.</strong> {caption}</figcaption>
</figure>"""
