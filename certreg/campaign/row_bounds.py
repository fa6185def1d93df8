"""What a row of a list says of pairs that may be wrong: the bound on residuals, what is sought."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from certreg.errors import InvalidFileError
from certreg.io.bounds import read_bounds
from certreg.io.streams import number
from certreg.problem.support import Loss
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.campaign.listing import PairRow
    from certreg.io.pairing import Pair


def bounds_file(row: PairRow) -> str | None:
    """The file that a row names as its bounds; None for a number, or nothing."""
    text = row.fields.get("max_residual")
    return None if text is None or _number(row, text) is not None else text


def fault_of_bounds(row: PairRow) -> str | None:
    """Why what a row says of wrong pairs does not go together, if it does not."""
    fields = row.fields
    beside = [name for name in ("objective", "effort") if name in fields]
    if beside and "max_residual" not in fields:
        return f"{beside[0]} goes with max_residual: give that, too"
    if fields.get("objective", Loss.CONSENSUS) not in {Loss.CONSENSUS, Loss.TRUNCATED}:
        known = f"write {Loss.CONSENSUS} or {Loss.TRUNCATED}"
        return f"objective is '{shown(fields['objective'])}': {known}"
    return None


def asked_of_bounds(row: PairRow, folder: Path, pair: Pair) -> dict[str, Any]:
    """The arguments of `certify` that a row gives, beside its problem; none without a bound."""
    text = row.fields.get("max_residual")
    if text is None:
        return {}
    file = bounds_file(row)
    if file is not None and not (folder / file).is_file():
        what = f"'{shown(file)}' is neither a number nor a file"
        raise row.place.at("max_residual").refusal(f"{what}: give one", value=file)
    asked = {
        "max_residual": _number(row, text) if file is None else read_bounds(folder / file, pair),
        "objective": row.fields.get("objective"),
    }
    effort = row.fields.get("effort")
    return asked if effort is None else asked | {"effort": number(row.place.at("effort"), effort)}


def _number(row: PairRow, text: str) -> float | None:
    try:
        return number(row.place.at("max_residual"), text)
    except InvalidFileError:
        return None
