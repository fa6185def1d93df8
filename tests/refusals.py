"""What a refusal of a file must hold: the file that it names, and a place in it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from certreg.verify import shown

OF_BOTH = re.compile(r"\d+ source but \d+ target points|the clouds have no label in common")


def wrong_evidence(message: str, evidence: dict[str, Any]) -> str | None:
    """What is wrong with the evidence of a refusal; None if nothing is."""
    path = evidence.get("path")
    if not (path is None or isinstance(path, Path)):
        return f"path is {path!r}"
    named = path is None or shown(path.name) in message or message.startswith("standard input")
    if not named and not OF_BOTH.match(message):
        return "the file is not named"
    for name, least in (("line", 1), ("row", 0)):
        place = evidence.get(name)
        if place is not None and not (type(place) is int and place >= least):
            return f"{name} is {place!r}"
    column = evidence.get("column")
    if not (column is None or type(column) is str):
        return f"column is {column!r}"
    for name in ("value", "limit"):
        if isinstance(evidence.get(name), Path | np.generic):
            return f"{name} is {evidence[name]!r}"
    return None
