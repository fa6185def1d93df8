"""The numbers of the maps as rows: of a CSV file, of the JSON document."""

from __future__ import annotations

import csv
import io
import math
from typing import TYPE_CHECKING, Any

from certreg.paper.maps import MEASURES

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from certreg.paper.maps import Map

MAPS = "maps.csv"


def rows(found: Sequence[Map]) -> Iterator[dict[str, Any]]:
    """A row for each value of each map.

    Of each measure the median, the worst and what theory tells of the median, None where it tells
    nothing or where the number is infinite: times in those of the springs. Then how many instances
    converged, how many the paper's rule stops more than 90 degrees from the optimum, and how many
    have exactly four equilibria.
    """
    for each in found:
        curves = {measure.name: each.curves(measure) for measure in MEASURES}
        for k, level in enumerate(each.levels):
            row: dict[str, Any] = {
                "map": each.family.name,
                "value": level.value,
                "instances": len(level.steps),
            }
            for name, curve in curves.items():
                row[f"{name}_median"] = _finite(curve.median[k])
                row[f"{name}_worst"] = _finite(curve.worst[k])
                row[f"{name}_told"] = _finite(curve.told[k])
            row["converged"] = int(level.converged.sum())
            row["lost_by_the_papers_rule"] = int(level.lost.sum())
            row["four_equilibria"] = int(level.four.sum())
            yield row


def table(found: Sequence[Map]) -> bytes:
    """The rows as CSV with a header; nothing where a number is None."""
    text = io.StringIO()
    listed = list(rows(found))
    writer = csv.DictWriter(text, list(listed[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(listed)
    return text.getvalue().encode()


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
