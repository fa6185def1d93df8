"""A campaign carried out: what its folder lacks is computed, what is there is kept."""

from __future__ import annotations

import hashlib
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from certreg.campaign.calls import outcomes
from certreg.campaign.shards import Shards
from certreg.errors import InvalidFileError
from certreg.files import write_atomically
from certreg.verify import shown

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterator, Mapping
    from pathlib import Path

    from certreg.campaign.calls import Call
    from certreg.campaign.manifest import Manifest
    from certreg.campaign.workers import Workers

SHARDS, CERTIFICATES = "shards", "certificates"


class Kind(Protocol):
    """What a campaign computes."""

    @property
    def suffix(self) -> str:
        """How the names of its shards end."""
        ...

    def manifest(self) -> Manifest:
        """Everything that the results depend on."""
        ...

    def calls(self, done: Container[int]) -> Iterator[Call]:
        """The work on the shards that are not done, in their order."""
        ...

    def files(self, content: bytes) -> Mapping[str, str]:
        """The SHA-256 of each file that goes with a shard, by name."""
        ...

    def final(self, content: bytes) -> bool:
        """Whether a shard need not be computed again."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Watch:
    """Who is told of a campaign: of shards that were there, of new ones, of what is odd."""

    begun: Callable[[int], None]  # items that were there
    advanced: Callable[[int], None]  # new items
    noted: Callable[[str], None]


def run(kind: Kind, folder: Path, workers: Workers, watch: Watch) -> dict[str, float]:
    """Compute what the folder, occupied by this process, lacks; seconds of the workers' time.

    Raises what `outcomes` raises, and InvalidFileError where a file cannot be written.
    """
    manifest = kind.manifest()
    shards = Shards(folder=folder / SHARDS, identity=manifest.identity(), suffix=kind.suffix)
    for note in shards.drop_damaged():
        watch.noted(note)
    done, former = _done(kind, shards, folder), shards.files()
    watch.begun(sum(len(manifest.items(shard)) for shard in done))
    timings: Counter[str] = Counter()
    for call, found in outcomes(kind.calls(done), workers, manifest.versions):
        for name, content in found.files.items():
            write_atomically(folder / CERTIFICATES / name, content)
        shards.replace(call.shard, found.content, former.get(call.shard, ()))
        timings.update(found.timings)
        watch.advanced(len(manifest.items(call.shard)))
    return dict(timings)


def contents(kind: Kind, folder: Path) -> Iterator[bytes]:
    """The shards of a campaign that has ended, one after the other.

    Raises InvalidFileError where one has been lost since.
    """
    manifest, expected = kind.manifest(), 0
    shards = Shards(folder=folder / SHARDS, identity=manifest.identity(), suffix=kind.suffix)
    for number, content in shards.sound():
        if number == expected:
            expected += 1
            yield content
    if expected != manifest.shards:
        message = f"{shown(folder)}: shard {expected} is gone: run the same command again"
        raise InvalidFileError(message)


def _done(kind: Kind, shards: Shards, folder: Path) -> set[int]:
    """The shards that are final, with all the files that go with them, and there once."""
    times: Counter[int] = Counter()
    final: set[int] = set()
    for number, content in shards.sound():
        times[number] += 1
        files = kind.files(content).items()
        if kind.final(content) and all(_is(folder / CERTIFICATES / n, d) for n, d in files):
            final.add(number)
    return {number for number in final if times[number] == 1}


def _is(path: Path, digest: str) -> bool:
    try:
        with path.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest() == digest
    except OSError:
        return False
