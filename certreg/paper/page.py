"""The verdicts and the figures as one page of HTML, and the folder that holds everything."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import TYPE_CHECKING, Any

from certreg.campaign.table import records_bytes
from certreg.errors import InvalidFileError
from certreg.io.atomic import remedy_of, write_atomically
from certreg.paper.documents import (
    CERTIFICATES,
    CERTIFICATES_EXPLAINED,
    FIGURES,
    KINDS,
    certified_words,
    closing_text,
    markdown,
    proof_words,
    reproduction_document,
    setup_words,
    verdict_word,
)
from certreg.paper.equilibrium_maps import SPRINGS_FILE, spring_rows
from certreg.paper.parameter_sweeps import SWEEPS_FILE, sweep_rows
from certreg.paper.style import written
from certreg.paper.terminal import plain
from certreg.report.document import dumps
from certreg.report.markup import rendered

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from certreg.paper.counterexamples import CertifiedCloud
    from certreg.paper.equilibrium_maps import SpringCounts
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
