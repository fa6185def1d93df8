"""Tables separated by semicolons, as spreadsheets write them where the comma is decimal.

`1,234` is one and a quarter in one country and a thousand in another. So commas in numbers are
read as decimal only where some number of the file shows that they are: `1,5` groups no thousands.
"""

from __future__ import annotations

import csv
import re
from typing import TYPE_CHECKING

from certreg.io.columns import axes_of
from certreg.io.streams import NUMBER, number
from certreg.verify import shown

if TYPE_CHECKING:
    from certreg.io.streams import Place

GROUPED = re.compile(r"[+-]?[1-9][0-9]{0,2},[0-9]{3}")  # 1,234: perhaps a thousand


def separated_by_semicolons(first: str) -> bool:
    """Whether the first row of a table is one of semicolons, not of commas."""
    if len(_fields(first, ";")) < 3:
        return False
    fields = _fields(first, ",")  # `1,5;2,5;3,5` has two numbers between its commas, never three
    numbers = sum(NUMBER.fullmatch(field) is not None for field in fields)
    return numbers < 3 and axes_of(fields) is None


def _fields(line: str, separator: str) -> list[str]:
    try:
        row = next(csv.reader([line], delimiter=separator), list[str]())
    except csv.Error:
        return []
    return [field.strip().lower() for field in row]


class DecimalCommas:
    """Numbers whose commas, if there are any, are found to be decimal or are refused."""

    def __init__(self) -> None:
        self._comma: tuple[Place, str] | None = None  # the first number with one
        self._point: tuple[Place, str] | None = None
        self._decimal = False

    def number(self, place: Place, text: str) -> float:
        """The double nearest to a decimal number with a point or a comma."""
        text = text.strip(" \t")
        if "," not in text:
            if "." in text:
                self._point = self._point or (place, text)
            return number(place, text)
        self._comma = self._comma or (place, text)
        if text.count(",") > 1 or not NUMBER.fullmatch(text.replace(",", ".")):
            words = f"'{shown(text)}' is not a number: write plain decimal numbers, without groups"
            raise place.refusal(words, value=text)
        self._decimal = self._decimal or not GROUPED.fullmatch(text)
        return number(place, text.replace(",", "."))

    def require_decimal(self) -> None:
        """That the commas met were decimal beyond doubt. Raises InvalidFileError."""
        if self._comma is None:
            return
        place, text = self._comma
        if self._point is not None:
            there, other = self._point
            words = f"'{shown(text)}' here and '{shown(other)}' in line {there.line}: is the comma "
            raise place.refusal(words + "decimal? Write decimal points", value=text)
        if not self._decimal:
            point, thousand = text.replace(",", "."), text.replace(",", "")
            words = f"'{shown(text)}': is it {point} or {thousand}? Write decimal points"
            raise place.refusal(words, value=text)

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know."""
        return () if self._comma is None else ("decimal commas",)
