"""The manifest of a campaign: everything that its results depend on, and nothing else.

No time, place or name of a machine stands in it: the same manifest gives the same bytes of
results, whoever computes them, in whatever order, however often interrupted.
"""

from __future__ import annotations

import hashlib
import json
import sys
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from certreg import __version__
from certreg.errors import InvalidFileError
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

FORMAT = "certreg-campaign/1"
MAX_BYTES = 1 << 16  # of a manifest: a kilobyte is usual


@dataclass(frozen=True, slots=True, kw_only=True)
class Manifest:
    """What is computed: `count` items of a kind, `shard_size` of them in each shard but the last.

    settings: of the kind, as JSON has them (seed, sizes, digests of input).
    versions: of what computes; results of others may differ in the last digit.
    """

    kind: str
    count: int
    shard_size: int
    settings: dict[str, Any]
    versions: dict[str, str]

    @property
    def shards(self) -> int:
        """How many shards the campaign has."""
        return -(-self.count // self.shard_size)

    def items(self, shard: int) -> range:
        """The items of a shard, counted from 0."""
        first = shard * self.shard_size
        return range(first, min(first + self.shard_size, self.count))

    def to_json(self) -> bytes:
        """The file `campaign.json`; equal manifests are equal bytes."""
        document = {"format": FORMAT, **asdict(self)}
        return (json.dumps(document, indent=1, sort_keys=True, allow_nan=False) + "\n").encode()

    def identity(self) -> str:
        """SHA-256 of the file, 64 hexadecimal digits."""
        return hashlib.sha256(self.to_json()).hexdigest()


def current_versions() -> dict[str, str]:
    """Versions of certreg, NumPy and Python in this process."""
    python = ".".join(map(str, sys.version_info[:2]))
    return {"certreg": __version__, "numpy": np.__version__, "python": python}


def require_same(path: Path, manifest: Manifest) -> None:
    """That the manifest kept at `path` is this one. Raises InvalidFileError: the first difference.

    So nobody mixes results of two seeds, settings or versions in one folder.
    """
    try:
        with path.open("rb") as stream:
            content = stream.read(MAX_BYTES)
        kept: dict[str, Any] = flat(json.loads(content))
    except OSError as error:
        message = f"{shown(path)}: cannot be read ({error.strerror}): choose another folder"
        raise InvalidFileError(message) from error
    except (ValueError, AttributeError, RecursionError) as error:
        message = f"{shown(path)}: is no manifest of a campaign: choose another folder"
        raise InvalidFileError(message) from error
    wanted = flat(json.loads(manifest.to_json()))
    for key in sorted(kept.keys() | wanted.keys()):
        if kept.get(key) != wanted.get(key):
            message = (
                f"{shown(path)}: another campaign stands there: its {shown(key)} is "
                f"{shown(kept.get(key))}, here it is {shown(wanted.get(key))}: choose another "
                "folder, or give what it was begun with"
            )
            raise InvalidFileError(message)


def flat(document: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    """The leaves of nested objects by their dotted names."""
    leaves: dict[str, Any] = {}
    for key, value in document.items():
        if isinstance(value, dict):
            leaves |= flat(cast("dict[str, Any]", value), f"{prefix}{key}.")
        else:
            leaves[prefix + key] = value
    return leaves
