"""One encoder for all documents: a missing value becomes a null, and its reason is collected."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from certreg.results import Absent

Document = dict[str, Any]

# The order of `reasons`: that of the document, but these first, each with all that is inside it.
# A value of one method stands beside the angle that this method misses.
ORDER = (
    *("objective", "rmse", "certificate", "pose", "optimality"),
    *("equilibria.count", "equilibria.complete", "equilibria", "margin"),
    *("relaxation", "agreement.relaxation_deg"),
    *("simulation.energy", "simulation", "agreement.simulation_deg"),
    "energy",
)
AS_THEY_ARE = frozenset((float, int, str, bool, type(None)))  # most of what a document holds


@dataclass(frozen=True, slots=True)
class Noted:
    """A value of a document that is there, but about which something is to be said."""

    value: Any
    reason: str


def encoded(document: Document) -> Document:
    """The document in JSON's types: null for Absent, and last the `reasons`, by path.

    Arrays become lists, complex numbers pairs.

    >>> encoded({"n": 1, "rates": {"slowest": Absent("not asked for")}})
    {'n': 1, 'rates': {'slowest': None}, 'reasons': {'rates.slowest': 'not asked for'}}
    """
    reasons: dict[str, str] = {}
    fields = _plain(document, "", reasons)
    return {**fields, "reasons": {path: reasons[path] for path in sorted(reasons, key=_rank)}}


def _plain(value: Any, path: str, reasons: dict[str, str]) -> Any:
    """The value in JSON's types; adds what is to be said of it, and of all in it, to `reasons`."""
    if type(value) in AS_THEY_ARE:
        return value
    if isinstance(value, Absent | Noted):
        reasons[path] = value.reason
        return None if isinstance(value, Absent) else _plain(value.value, path, reasons)
    if isinstance(value, np.ndarray):
        return _numbers(value).tolist()
    if isinstance(value, dict):
        inner = cast("Document", value)
        within = f"{path}." if path else ""
        return {
            key: each if type(each) in AS_THEY_ARE else _plain(each, within + key, reasons)
            for key, each in inner.items()
        }
    if isinstance(value, list | tuple):
        row = cast("list[Any]", value)
        return [_plain(each, f"{path}[{i}]", reasons) for i, each in enumerate(row)]
    return value


def _numbers(array: Any) -> Any:
    """A complex array with its parts as a last axis; others as they are."""
    return np.stack([array.real, array.imag], axis=-1) if np.iscomplexobj(array) else array


def _rank(path: str) -> int:
    """The place in ORDER of the longest entry that holds the path."""
    holding = [name for name in ORDER if path == name or path.startswith((f"{name}.", f"{name}["))]
    return ORDER.index(max(holding, key=len)) if holding else len(ORDER)
