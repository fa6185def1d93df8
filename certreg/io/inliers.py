"""A file of labels: 0 or 1, outlier or inlier, for each row of the source."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.errors import InvalidFileError
from certreg.io.text import read_words
from certreg.problem import INLIER_WORDS
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

    from certreg.io.clouds import Pair


def read_inliers(path: Path, pair: Pair) -> list[bool]:
    """Whether each of the pairs is labelled as an inlier, from text with one label a line.

    Raises InvalidFileError where the file cannot be read, holds other words or another number.
    """
    labels: list[bool] = []
    for place, word in read_words(path):
        if word not in INLIER_WORDS:
            what = f"'{shown(word)}' is no label"
            raise place.refusal(f"{what}: write 0 or 1, outlier or inlier", value=word)
        labels.append(INLIER_WORDS[word])
    rows, n = pair.source_rows, pair.sizes[0]
    if len(labels) != n:
        message = (
            f"{shown(path)}: holds {len(labels)} labels, the source has {n} rows: give one for "
            "each of them"
        )
        raise InvalidFileError(message, path=path, value=len(labels), limit=n)
    return labels if rows is None else [labels[row] for row in rows.tolist()]
