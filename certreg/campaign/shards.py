"""Shards: the results of a few items each, in files that are whole or not there.

A file is called NUMBER-DIGEST.SUFFIX. The digest is over the campaign's identity, the number and
the content, so a file that is damaged, cut short, renamed or from elsewhere is seen. One rename
puts content and digest in place at once: there is no moment at which a kill could part them.
"""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from certreg.io import write_atomically
from certreg.settings import CampaignSettings
from certreg.verify import shown

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

DIGITS = 32  # of the digest, hexadecimal: no accident makes two contents agree in 128 bits
NAME = re.compile(rf"([0-9]{{8}})-[0-9a-f]{{{DIGITS}}}\.[a-z]+")


@dataclass(frozen=True, slots=True, kw_only=True)
class Shards:
    """The shards of one campaign in one folder; `identity` is its manifest's."""

    folder: Path
    identity: str
    suffix: str

    def replace(self, number: int, content: bytes, former: Sequence[Path] = ()) -> None:
        """Put a shard in place, whole; its former files go then. Raises InvalidFileError."""
        place = self.folder / self._name(number, content)
        write_atomically(place, content)
        for path in former:
            if path != place:
                path.unlink()

    def files(self) -> dict[int, list[Path]]:
        """The files of each shard; more than one where a run was killed between the two."""
        found: dict[int, list[Path]] = {}
        for number, path in self._numbered():
            found.setdefault(number, []).append(path)
        return found

    def sound(self) -> Iterator[tuple[int, bytes]]:
        """Number and content of each shard that is there and whole, in order."""
        for number, path in self._numbered():
            content = self._content(number, path)
            if content is not None:
                yield number, content

    def drop_damaged(self) -> list[str]:
        """Delete what is no whole shard of this campaign; a note on each."""
        notes: list[str] = []
        for number, path in self._numbered():
            if self._content(number, path) is None:
                path.unlink()
                notes.append(f"{shown(path)}: damaged, or not of this campaign: computed anew")
        return notes

    def _numbered(self) -> list[tuple[int, Path]]:
        """What is called as a shard is, in order; other files are nobody's business."""
        files = ((NAME.fullmatch(path.name), path) for path in self.folder.iterdir())
        return sorted((int(name[1]), path) for name, path in files if name is not None)

    def _name(self, number: int, content: bytes) -> str:
        digest = hashlib.sha256(f"{self.identity} {number}\n".encode() + content).hexdigest()
        return f"{number:08d}-{digest[:DIGITS]}{self.suffix}"

    def _content(self, number: int, path: Path) -> bytes | None:
        """The content of a file if its name is what it should be."""
        with path.open("rb") as stream:
            content = stream.read(CampaignSettings().max_bytes)
        return content if path.name == self._name(number, content) else None
