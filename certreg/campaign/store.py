"""What a campaign keeps: a manifest that says what is computed, and the shards of its results.

The manifest holds everything that the results depend on, and nothing else: no time, place or name
of a machine. The same manifest gives the same bytes of results, whoever computes them, in whatever
order, however often interrupted.

A shard, the results of a few items, is a file that is whole or not there, called
NUMBER-DIGEST.SUFFIX. The digest is over the campaign's identity, the number and the content, so a
file that is damaged, cut short, renamed or from elsewhere is seen. One rename puts content and
digest in place at once: there is no moment at which a kill could part them.

What the last bits of results depend on beside versions is compiled code or not, and processors. The
compiled code gives the same bits in each of its variants. Python in its place need not give those.
NumPy, its linear algebra and the system's functions choose their code by the processor. Each is
known by a digest of what it makes of given numbers, so that a manifest says which it was.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import re
import sys
from collections.abc import Generator, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg import __version__
from certreg._loading import library
from certreg.errors import CampaignError, InvalidFileError
from certreg.io.atomic import TEMPORARY, write_atomically
from certreg.io.streams import refused, require_ending
from certreg.native.library import library_if_any
from certreg.verify import shown

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from certreg.results import Json

    Reals = NDArray[np.float64]

MANIFEST, SHARDS, CERTIFICATES = "campaign.json", "shards", "certificates"  # within the folder
FORMAT = "certreg-campaign/1"
LOCK = f"{TEMPORARY}lock"  # on Windows: locked while a run lasts; the file itself says nothing
MAX_MANIFEST_BYTES = 1 << 16  # a kilobyte is usual
MAX_SHARD_BYTES = 1 << 30  # 400 kB are usual
DIGITS = 32  # of the digest, hexadecimal: no accident makes two contents agree in 128 bits
NAME = re.compile(rf"([0-9]{{8}})-[0-9a-f]{{{DIGITS}}}\.[a-z]+")


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
    """Versions of certreg, NumPy and Python in this process, and what else its bits depend on.

    Raises VariantError where the environment names a variant of the kernels that is not there.
    """
    python = ".".join(map(str, sys.version_info[:2]))
    named = {"certreg": __version__, "numpy": np.__version__, "python": python}
    return named | arithmetic()


def require_same(path: Path, manifest: Manifest) -> None:
    """That the manifest kept at `path` is this one. Raises InvalidFileError: the first difference.

    So results of two seeds, settings or versions are never mixed in one folder.
    """
    try:
        require_ending(path)
        with path.open("rb") as stream:
            content = stream.read(MAX_MANIFEST_BYTES)
        kept: dict[str, Any] = flat(json.loads(content))
    except OSError as error:
        raise refused(path, f"cannot be read ({error.strerror}): choose another folder") from error
    except (ValueError, AttributeError, RecursionError) as error:
        raise refused(path, "is no manifest of a campaign: choose another folder") from error
    wanted = flat(json.loads(manifest.to_json()))
    for key in sorted(kept.keys() | wanted.keys()):
        if kept.get(key) != wanted.get(key):
            differs = (
                f"its {shown(key)} is {shown(kept[key])}, here it is {shown(wanted[key])}: choose "
                "another folder, or give what it was begun with"
                if key in kept.keys() & wanted.keys()
                else f"only {'it' if key in kept else 'this version'} knows {shown(key)}: choose "
                "another folder, or go on with the version of certreg that began it"
            )
            raise refused(
                path,
                f"another campaign stands there: {differs}",
                column=key,
                value=kept.get(key),
                limit=wanted.get(key),
            )


def flat(document: dict[str, Json], prefix: str = "") -> dict[str, Any]:
    """The leaves of nested objects by their dotted names."""
    leaves: dict[str, Any] = {}
    for key, value in document.items():
        leaves |= (
            flat(value, f"{prefix}{key}.") if isinstance(value, dict) else {prefix + key: value}
        )
    return leaves


@contextmanager
def occupied(folder: Path, manifest: Manifest) -> Generator[None]:
    """Make the folder, or resume in it; no other process works there until the end of the block.

    Raises InvalidFileError where it holds another campaign or anything else, CampaignError where
    another process is at work in it.
    """
    with _complaints(folder):
        folder.mkdir(parents=True, exist_ok=True)
    with _locked(folder):
        with _complaints(folder):
            _prepare(folder, manifest)
        yield


def _prepare(folder: Path, manifest: Manifest) -> None:
    names = {entry.name for entry in folder.iterdir()}
    if MANIFEST in names:
        require_same(folder / MANIFEST, manifest)
    elif any(not name.startswith(TEMPORARY) for name in names):
        raise refused(folder, "holds other files: choose a new folder, or empty it")
    for place in (folder, folder / SHARDS, folder / CERTIFICATES):
        place.mkdir(exist_ok=True)
        for left_over in place.glob(f"{TEMPORARY}*"):
            if left_over.name != LOCK:
                left_over.unlink()
    if MANIFEST not in names:
        write_atomically(folder / MANIFEST, manifest.to_json())


@contextmanager
def _complaints(folder: Path) -> Generator[None]:
    """What the system refuses, as an InvalidFileError."""
    try:
        yield
    except OSError as error:
        place = shown(error.filename or folder)
        raise InvalidFileError(
            f"{place}: cannot be used ({error.strerror}): choose another folder",
            path=Path(error.filename or folder),
        ) from error


@contextmanager
def _locked(folder: Path) -> Generator[None]:
    """The folder locked against other processes; the lock ends with this process, however it ends.

    The system's own lock (flock, LockFileEx) of a descriptor that is opened here: the classes of
    filelock may fall back on files that stay after a kill, its `lock_descriptor` does not. Where
    there is no such lock (some network disks) two runs may do the same work, and every file is
    still whole.
    """
    handle = lockable(folder)
    try:
        free = True
        with suppress(OSError):  # this disk has no locks
            free = try_lock(handle)
        if not free:
            raise CampaignError(
                f"{shown(folder)}: another process is at work there: wait for it, or stop it",
                path=folder,
            )
        yield
    finally:
        os.close(handle)


def try_lock(handle: int) -> bool:
    """Lock a descriptor until it is closed, if nobody holds it. Raises OSError without locks."""
    return bool(library("filelock", "a campaign").lock_descriptor(handle, blocking=False))


def lockable(folder: Path) -> int:
    """A descriptor to lock: of the folder or, on Windows, which opens none, of a file in it."""
    if os.name == "nt":
        return os.open(folder / LOCK, os.O_RDWR | os.O_CREAT)
    return os.open(folder, os.O_RDONLY)


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
        paths: dict[int, list[Path]] = {}
        for number, path in self._numbered():
            paths.setdefault(number, []).append(path)
        return paths

    def sound(self) -> Iterator[tuple[int, bytes]]:
        """Number and content of each shard that is there and whole, in order."""
        for number, path in self._numbered():
            content = self._content(number, path)
            if content is not None:
                yield number, content

    def drop_damaged(self) -> list[str]:
        """Delete files that are not whole shards of this campaign; a note on each."""
        notes: list[str] = []
        for number, path in self._numbered():
            if self._content(number, path) is None:
                path.unlink()
                notes.append(f"{shown(path)}: damaged, or not of this campaign: computed anew")
        return notes

    def _numbered(self) -> list[tuple[int, Path]]:
        """The files whose names are those of shards, in order; other files are left alone."""
        files = ((NAME.fullmatch(path.name), path) for path in self.folder.iterdir())
        return sorted((int(name[1]), path) for name, path in files if name is not None)

    def _name(self, number: int, content: bytes) -> str:
        digest = hashlib.sha256(f"{self.identity} {number}\n".encode() + content).hexdigest()
        return f"{number:08d}-{digest[:DIGITS]}{self.suffix}"

    def _content(self, number: int, path: Path) -> bytes | None:
        """The content of a file if its name is what it should be."""
        with path.open("rb") as stream:
            content = stream.read(MAX_SHARD_BYTES)
        return content if path.name == self._name(number, content) else None


def digest_of(path: Path) -> str | None:
    """SHA-256 of a file; None where it is not there or cannot be read twice, as a pipe."""
    try:
        if not path.is_file():
            return None
        with path.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except (OSError, ValueError):
        return None


COUNT = 1000  # of arguments: functions that round otherwise differ in one of some hundred
SIZES = (3, 4, 9, 40)  # of matrices: small ones have code of their own
FINGERPRINT_DIGITS = 12


@cache
def arithmetic() -> dict[str, str]:
    """What computes in this process, by name; milliseconds, once.

    Raises VariantError where the environment names a variant that is not there.
    """
    numbers = np.random.default_rng(1).uniform(0.01, 3.0, COUNT)
    return {
        "kernels": "python" if library_if_any() is None else "compiled",
        "numpy_bits": _digest(_of_numpy(numbers)),
        "linear_algebra_bits": _digest(_of_linear_algebra(numbers)),
        "libm_bits": _digest(_of_the_system(numbers)),
    }


def _of_numpy(numbers: Reals) -> Iterator[ArrayLike]:
    for name in ("sin", "cos", "arccos", "arctan", "exp", "log", "log1p", "cbrt", "tanh"):
        yield getattr(np, name)(numbers / 3.0)
    for name in ("hypot", "arctan2", "power", "divide"):
        yield getattr(np, name)(numbers, numbers[::-1])
    rows = numbers.reshape(-1, 4)
    yield from (np.sum(numbers), rows.sum(axis=0), rows.sum(axis=1), np.var(numbers))
    yield np.einsum("ij,ik->jk", rows, rows)


def _of_linear_algebra(numbers: Reals) -> Iterator[ArrayLike]:
    rows = numbers[:900].reshape(-1, 3)
    yield from (rows.T @ rows, rows @ rows[:3], numbers @ numbers, np.linalg.norm(rows))
    for size in SIZES:
        matrix = np.resize(numbers, (size, size)) + np.eye(size)
        symmetric = matrix @ matrix.T
        yield from (symmetric, np.linalg.inv(matrix), np.linalg.solve(matrix, matrix.T))
        yield from (
            *np.linalg.eigh(symmetric),
            *np.linalg.svd(matrix),
            np.linalg.cholesky(symmetric),
        )


def _of_the_system(numbers: Reals) -> Iterator[ArrayLike]:
    given: list[float] = numbers.tolist()
    for function in (math.sin, math.cos, math.exp, math.log, math.atan, math.gamma):
        yield np.array([function(x) for x in given])
    yield np.array([x**y for x, y in zip(given, given[::-1], strict=True)])


def _digest(results: Iterable[ArrayLike]) -> str:
    whole = hashlib.sha256()
    for result in results:
        whole.update(np.asarray(result, dtype="<f8").tobytes())
    return whole.hexdigest()[:FINGERPRINT_DIGITS]
