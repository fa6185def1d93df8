"""A campaign carried out: what its folder lacks is computed, what is there is kept."""

from __future__ import annotations

import hashlib
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from certreg.campaign.calls import outcomes
from certreg.campaign.shards import Shards
from certreg.errors import InvalidFileError
from certreg.io import write_atomically
from certreg.verify import shown

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterable, Iterator, Mapping
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
        """Whether a shard need not be computed again, if its inputs are as they were."""
        ...

    def changed(self, content: bytes) -> Iterable[str]:
        """The inputs of a shard that are not as they were, by name."""
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
    kept, former = _kept(kind, shards, folder), shards.files()
    done = kept.done
    if kept.changed:
        watch.noted(_changed_words(kept.changed))
    watch.begun(sum(len(manifest.items(shard)) for shard in done))
    timings: Counter[str] = Counter()
    for call, found in outcomes(kind.calls(done), workers, manifest.versions):
        for name, content in found.files.items():
            write_atomically(folder / CERTIFICATES / name, content)
        for name in kept.files.get(call.shard, set()) - found.files.keys():
            (folder / CERTIFICATES / name).unlink(missing_ok=True)
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


def digest_of(path: Path) -> str | None:
    """SHA-256 of a file; None where there is none that can be read more than once."""
    try:
        if not path.is_file():
            return None
        with path.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except (OSError, ValueError):
        return None


@dataclass(frozen=True, slots=True, kw_only=True)
class _Kept:
    """What an earlier run left.

    done: shards that are final, of the inputs that are there now, with all the files that go with
    them, and there once. files: those that go with each other shard. changed: inputs, by name.
    """

    done: set[int]
    files: dict[int, set[str]]
    changed: dict[str, None]  # in their order


def _kept(kind: Kind, shards: Shards, folder: Path) -> _Kept:
    times: Counter[int] = Counter()
    final: set[int] = set()
    named: dict[int, set[str]] = {}
    changed: dict[str, None] = {}
    for number, content in shards.sound():
        times[number] += 1
        files, other = kind.files(content), dict.fromkeys(kind.changed(content))
        named.setdefault(number, set()).update(files)
        changed |= other
        sound = all(digest_of(folder / CERTIFICATES / n) == d for n, d in files.items())
        if kind.final(content) and sound and not other:
            final.add(number)
    done = {number for number in final if times[number] == 1}
    return _Kept(
        done=done, files={k: names for k, names in named.items() if k not in done}, changed=changed
    )


def _changed_words(names: dict[str, None]) -> str:
    first, more = next(iter(names)), len(names) - 1
    others = f" and {more} more" if more else ""
    return f"{shown(first)}{others}: changed since the last run: computed anew"
