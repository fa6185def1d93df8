"""A campaign over random instances as the paper makes them: whether they have its equilibria.

Shard k draws from child k of `numpy.random.SeedSequence(seed).spawn(...)`, so its instances depend
on the manifest alone. Doubles decide almost all of them; an instance that they do not decide, or
that has other counts than 0, 1, 2, 3, is decided in exact arithmetic and kept with its certificate.
"""

from __future__ import annotations

import hashlib
import io
import json
import math
import time
from abc import abstractmethod
from collections.abc import Callable, Container, Iterator
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg import __version__
from certreg.campaign.runner import Campaign, contents
from certreg.campaign.store import CERTIFICATES, Manifest, current_versions
from certreg.campaign.table import Block, Column, csv_bytes, write_table
from certreg.campaign.workers import Task, TaskResult
from certreg.equilibrium.batch import Solutions, solve_many
from certreg.errors import InvalidProblemError
from certreg.geometry.so3 import rotation_matrices
from certreg.io.atomic import write_atomically
from certreg.problem.problem import RegistrationProblem
from certreg.problem.random_instances import (
    PAPER_DAMPING,
    PAPER_POINTS,
    PAPER_SIGMA,
    Instances,
    gaussian_instances,
)
from certreg.registration.certification import certify

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from certreg.registration.result import Registration


Arrays = dict[str, "NDArray[Any]"]

# No result depends on how a campaign is cut up but by the manifest, which a folder keeps.
SHARD_POINTS = 1 << 19  # a tenth of a second of work
SHARD_INSTANCES = 4096  # 400 kB of results
SHARDS = 64  # at least, where there are so many instances: all workers have work
LEAST_INSTANCES = 256  # in a shard all the same: milliseconds of work
PIECE_POINTS = 1 << 15  # of instances made at a time: two megabytes stay in the cache
EXCEPTIONS, TOTALS = "exceptions.csv", "totals.json"
PAPER_COUNTS = (0, 1, 2, 3)  # unstable eigenvalues at the four equilibria
INSTANCE_COLUMNS = (
    Column("instance", int, "", "number of the instance, from 0"),
    *(Column(f"rmse_{k}", float, "1", f"RMSE at the pose of index {k}") for k in range(4)),
    *(Column(f"unstable_{k}", int, "", "unstable eigenvalues there; -1 unknown") for k in range(4)),
    Column("margin", float, "1", "least gap of neighbouring eigenvalues over their range"),
    Column("rotation_error_rad", float, "rad", "from the optimum to the rotation it was made by"),
    Column("translation_error", float, "1", "the same of the translation"),
    Column("half_turn_error_rad", float, "rad", "how far the others are from 180 degrees of it"),
    Column("exact", int, "", "1 if exact arithmetic decided the counts, 0 if doubles sufficed"),
)
EXTREMES = ("margin", "rotation_error_rad", "translation_error", "half_turn_error_rad")
EXCEPTION_COLUMNS = ("instance", "pattern", "unstable", "certificate")


class RandomCampaign(Campaign):
    """A campaign over random instances, which are made of its manifest alone.

    Shards are archives of arrays.
    """

    suffix = ".npz"

    @property
    @abstractmethod
    def work(self) -> Callable[..., TaskResult]:
        """What computes a shard, of `manifest` and `shard`."""

    def tasks(self, done: Container[int]) -> Iterator[Task]:
        """Each shard that is not done."""
        manifest = self.manifest()
        for shard in range(manifest.shards):
            if shard not in done:
                arguments = {"manifest": manifest, "shard": shard}
                yield Task(shard=shard, function=self.work, arguments=arguments)

    def _least(self, words: str, **least: int) -> None:
        """Raises InvalidProblemError where one of the numbers is below its least."""
        for name, limit in least.items():
            given = getattr(self, name)
            if given < limit:
                raise InvalidProblemError(words, array=name, value=given, limit=limit)


@dataclass(frozen=True, slots=True, kw_only=True)
class MonteCarlo(RandomCampaign):
    """Random instances of the paper's experiments: N points, noise sigma, damping mu; a seed."""

    count: int
    points: int = PAPER_POINTS
    sigma: float = PAPER_SIGMA
    damping: float = PAPER_DAMPING
    seed: int = 0

    def manifest(self) -> Manifest:
        """All of it. Raises InvalidProblemError where it is no campaign."""
        words = "give at least one instance of at least one point, and a seed >= 0"
        self._least(words, count=1, points=1, seed=0)
        given = asdict(self)
        fair = max(LEAST_INSTANCES, self.count // SHARDS)
        most = min(SHARD_INSTANCES, SHARD_POINTS // self.points)
        return Manifest(
            kind="monte-carlo",
            count=given.pop("count"),
            shard_size=max(1, min(fair, most)),
            settings={**given, "piece": max(1, PIECE_POINTS // self.points)},
            versions=current_versions(),
        )

    @property
    def work(self) -> Callable[..., TaskResult]:
        """Instances solved, those that are exceptions certified."""
        return solved

    def files(self, content: bytes) -> dict[str, str]:
        """The certificates of a shard's exceptions."""
        arrays = unpacked(content)
        digests = arrays["exception_sha256"]
        return {
            certificate_name(k): digest.tobytes().hex()
            for k, digest in zip(arrays["exception"].tolist(), digests, strict=True)
            if digest.any()
        }


def pieces(manifest: Manifest, shard: int) -> Iterator[tuple[int, Instances]]:
    """The instances of a shard, some at a time, with the number of the first of them.

    The same doubles whenever and wherever they are made.
    """
    given, items = manifest.settings, manifest.items(shard)
    rng = np.random.default_rng(np.random.SeedSequence(given["seed"], spawn_key=(shard,)))
    for first in range(items.start, items.stop, given["piece"]):
        count = min(given["piece"], items.stop - first)
        yield (
            first,
            gaussian_instances(rng, points=given["points"], sigma=given["sigma"], count=count),
        )


def solved(*, manifest: Manifest, shard: int) -> TaskResult:
    """The instances of a shard solved, those that are exceptions certified."""
    damping = manifest.settings["damping"]
    parts: list[Arrays] = []
    files: dict[str, bytes] = {}
    solving, start = 0.0, time.perf_counter()
    for first, made in pieces(manifest, shard):
        before = time.perf_counter()
        solutions = solve_many(made.sources, made.targets, damping=damping, threads=1)
        solving += time.perf_counter() - before
        part = _measured(solutions, made, first)
        part |= _exceptions(part, made, damping, files)
        parts.append(part)
    arrays = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    total = time.perf_counter() - start
    return TaskResult(
        content=packed(arrays), files=files, timings={"solving": solving, "all": total}
    )


def packed(arrays: Arrays) -> bytes:
    """Arrays as an .npz archive; equal arrays are equal bytes."""
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)  # pyright: ignore[reportArgumentType]
    return buffer.getvalue()


def unpacked(content: bytes) -> Arrays:
    """The arrays of a shard."""
    with np.load(io.BytesIO(content), allow_pickle=False) as archive:
        return {name: archive[name] for name in archive.files}


def certificate_name(instance: int) -> str:
    """The file of the certificate of an exception."""
    return f"instance-{instance:09d}.json"


@dataclass(frozen=True, slots=True, kw_only=True)
class Totals:
    """What the instances of a campaign amount to.

    regular: instances with exactly four equilibria, of 0, 1, 2 and 3 unstable eigenvalues.
    exceptions: instances decided in exact arithmetic, regular or not, each with its certificate.
    largest, smallest: over all instances, by the name of the column.
    """

    count: int
    regular: int
    exceptions: int
    largest: dict[str, float]
    smallest: dict[str, float]


def write_instance_results(kind: MonteCarlo, folder: Path, *, parquet: bool = False) -> Totals:
    """Write the table of all instances, `exceptions.csv` and `totals.json`; what they amount to.

    Raises InvalidFileError, MissingToolError.
    """
    exceptions: list[list[Any]] = [list(EXCEPTION_COLUMNS)]
    lows: dict[str, float] = dict.fromkeys(EXTREMES, math.inf)
    highs: dict[str, float] = dict.fromkeys(EXTREMES, -math.inf)
    regular = 0

    def blocks() -> Iterator[Block]:
        nonlocal regular
        for content in contents(kind, folder):
            arrays = unpacked(content)
            exceptions.extend(_listed(arrays))
            regular += int((arrays["unstable"] == PAPER_COUNTS).all(axis=1).sum())
            for name in EXTREMES:
                lows[name] = min(lows[name], float(arrays[name].min()))
                highs[name] = max(highs[name], float(arrays[name].max()))
            yield _columns(arrays)

    write_table(folder, INSTANCE_COLUMNS, blocks(), parquet=parquet)
    write_atomically(folder / EXCEPTIONS, csv_bytes(exceptions))
    totals = Totals(
        count=kind.count,
        regular=regular,
        exceptions=len(exceptions) - 1,
        largest=highs,
        smallest=lows,
    )
    write_atomically(folder / TOTALS, (json.dumps(asdict(totals), indent=1) + "\n").encode())
    return totals


def _columns(arrays: Arrays) -> Block:
    """The columns of the table, of a shard."""
    exact = np.isin(arrays["instance"], arrays["exception"]).astype(int)
    wide = (arrays["rmse"].T, arrays["unstable"].T)
    single = [arrays[name].tolist() for name in EXTREMES]
    return [
        arrays["instance"].tolist(),
        *(column.tolist() for matrix in wide for column in matrix),
        *single,
        exact.tolist(),
    ]


def _listed(arrays: Arrays) -> Iterator[list[Any]]:
    """The rows of the list of exceptions, of a shard."""
    unstable = arrays["unstable"][np.isin(arrays["instance"], arrays["exception"])]
    names = ("exception", "exception_pattern", "exception_sha256")
    for instance, pattern, digest, counts in zip(
        *(arrays[n] for n in names), unstable, strict=True
    ):
        place = f"{CERTIFICATES}/{certificate_name(int(instance))}" if digest.any() else None
        words = [
            " ".join(str(k) for k in row.tolist() if k > least)
            for row, least in ((pattern, 0), (counts, -1))
        ]
        yield [int(instance), *words, place]


def _measured(solutions: Solutions, made: Instances, first: int) -> Arrays:
    """What is kept of each instance, by doubles."""
    best, count = solutions.quaternions[:, 0], len(made.sources)
    rotations = rotation_matrices(best)
    chords = np.sqrt(((rotations - made.rotations) ** 2).sum(axis=(1, 2))) / np.sqrt(8.0)
    shifts = solutions.translations[:, 0] - made.translations
    cosines = np.abs((best[:, np.newaxis] * solutions.quaternions[:, 1:]).sum(axis=2)).max(axis=1)
    return {
        "instance": np.arange(first, first + count),
        "rmse": solutions.rmse,
        "unstable": np.where(solutions.decided[:, np.newaxis], solutions.unstable, np.int8(-1)),
        "margin": solutions.margins,
        "rotation_error_rad": 2.0 * np.arcsin(np.minimum(chords, 1.0)),
        "translation_error": np.sqrt((shifts * shifts).sum(axis=1)),
        "half_turn_error_rad": 2.0 * np.arcsin(np.minimum(cosines, 1.0)),
    }


def _exceptions(part: Arrays, made: Instances, damping: float, files: dict[str, bytes]) -> Arrays:
    """What doubles leave open or find otherwise, decided exactly; certificates to `files`.

    Puts the exact counts in the place of the others.
    """
    rows = np.flatnonzero((part["unstable"] != PAPER_COUNTS).any(axis=1)).tolist()
    patterns = np.zeros((len(rows), 4), dtype=np.int8)
    digests = np.zeros((len(rows), 32), dtype=np.uint8)
    for k, row in enumerate(rows):
        instance = int(part["instance"][row])
        problem = RegistrationProblem(made.sources[row], made.targets[row], damping=damping)
        about = {"certreg": __version__, "instance": instance}
        registration = certify(problem, relaxation=False, simulation=False, about=about)
        pattern = registration.equilibria.classification.pattern
        patterns[k, : len(pattern)] = pattern
        part["unstable"][row] = _counts(registration)
        if registration.certificate is not None:
            content = registration.certificate.to_json()
            files[certificate_name(instance)] = content
            digests[k] = np.frombuffer(hashlib.sha256(content).digest(), dtype=np.uint8)
    return {
        "exception": part["instance"][rows],
        "exception_pattern": patterns,
        "exception_sha256": digests,
    }


def _counts(registration: Registration) -> list[int]:
    """Unstable eigenvalues of the components, by index; -1 where there are fewer, or none known."""
    counts = [c.unstable_eigenvalues for c in registration.equilibria.components]
    known = [-1 if count is None else count for count in counts]
    return known + [-1] * (4 - len(known))
