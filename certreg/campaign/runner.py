"""A campaign carried out by workers: what its folder lacks is computed, what is there is kept.

A bounded number of tasks is under way, and those of dead workers are repeated.
"""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections import Counter, deque
from collections.abc import Callable, Container, Generator, Iterable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass
from pathlib import Path

from certreg.campaign.store import (
    CERTIFICATES,
    SHARDS,
    Manifest,
    Shards,
    current_versions,
    digest_of,
)
from certreg.campaign.workers import Task, TaskResult, Workers
from certreg.errors import (
    CampaignError,
    CertregError,
    ContradictionError,
    RefusedCertificateError,
)
from certreg.io.atomic import write_atomically
from certreg.io.streams import refused
from certreg.verify import shown

UNDER_WAY = 3  # tasks per worker: one at work, two that wait for it
SPREAD = 64  # shards per worker from the first under way: bounds what must wait for its turn
BREAKDOWNS = 3  # of the pool in a row, without one result in between
TICK = 5.0  # seconds between two counts of the workers
# What dask's futures raise where a worker dies just when its result arrives: they take it for an
# exception, its type and its traceback.
MISTAKEN = f"cannot unpack non-iterable {TaskResult.__name__} object"


class Campaign(ABC):
    """What a campaign computes.

    Of a kind that is made of its manifest alone a shard says again whatever it said, and nothing
    goes with it.
    """

    suffix: str  # how the names of its shards end

    @abstractmethod
    def manifest(self) -> Manifest:
        """Everything that the results depend on."""

    @abstractmethod
    def tasks(self, done: Container[int]) -> Iterator[Task]:
        """The work on the shards that are not done, in their order."""

    def files(self, content: bytes) -> Mapping[str, str]:
        """The SHA-256 of each file that goes with a shard, by name."""
        del content
        return {}

    def final(self, content: bytes) -> bool:
        """Whether a shard need not be computed again, if its inputs are as they were."""
        del content
        return True

    def changed(self, content: bytes) -> Iterable[str]:
        """The inputs of a shard that are not as they were, by name."""
        del content
        return ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Observer:
    """What is called while a campaign runs: with items that were there, new ones, and warnings."""

    begun: Callable[[int], None]  # items that were there
    advanced: Callable[[int], None]  # new items
    noted: Callable[[str], None]


def completed(
    tasks: Iterator[Task], workers: Workers, versions: dict[str, str]
) -> Generator[tuple[Task, TaskResult]]:
    """Tasks with their results, as they end; `tasks` come in order of their shards.

    It ends when all tasks are done. Without any worker one task is under way and waits for one. A
    bounded number is under way, and none far ahead of the first of them: tasks are drawn, and
    results held, no faster than asked for. Raises CampaignError where workers keep dying, fail, or
    have other versions than `versions`; ContradictionError where certreg contradicts itself. What
    is under way then ends with the workers.
    """
    scheduler, breakdowns = _Scheduler(tasks, workers, versions), 0
    while scheduler.fill():
        for future in scheduler.ended():
            task = scheduler.under_way.pop(future)
            result = _result(future, task, workers)
            if result is None:
                scheduler.again.append(task)
            else:
                breakdowns = 0
                yield task, result
        if scheduler.again:
            breakdowns += 1
            _require_hope(breakdowns, scheduler.again)
            workers.renew()


def in_order(completed_tasks: Iterable[tuple[Task, TaskResult]]) -> Iterator[TaskResult]:
    """Results in the order of their shards, from shard 0 on without a gap."""
    early: dict[int, TaskResult] = {}
    due = 0
    for task, result in completed_tasks:
        early[task.shard] = result
        while due in early:
            yield early.pop(due)
            due += 1


def perform(task: Task, versions: dict[str, str]) -> TaskResult:
    """Carry out a task in this process, a worker's, if it is of the campaign's versions."""
    here = current_versions()
    if here != versions:
        names = [name for name in here | versions if here.get(name) != versions.get(name)]
        raise CampaignError(
            f"a worker has {_listed(here, names)}, the campaign {_listed(versions, names)}: "
            "install the same everywhere, on processors of one kind",
            value=here,
            limit=versions,
        )
    try:
        return task.function(**task.arguments)
    except RefusedCertificateError as error:  # holds a verdict: does not travel between processes
        raise ContradictionError(str(error), methods=("certify", "verify")) from None


def perform_at(place: Path, task: Task, versions: dict[str, str]) -> Path:
    """Carry out a task and leave its result in a folder; a failure comes without its traceback.

    So what travels to the campaign is short.
    """
    try:
        return perform(task, versions).left_at(place / str(task.shard))
    except Exception as error:  # noqa: BLE001 - whatever it is, it goes on
        raise error.with_traceback(None) from None


class _Scheduler:
    """What is under way, what is to be done again, and what has not been begun."""

    def __init__(self, tasks: Iterator[Task], workers: Workers, versions: dict[str, str]) -> None:
        self.under_way: dict[Future[TaskResult | Path], Task] = {}
        self.again: deque[Task] = deque()
        self._tasks, self._workers, self._versions = tasks, workers, versions
        self._furthest, self._counted = -1, time.monotonic()

    def fill(self) -> bool:
        """Send tasks to the workers until enough are under way; whether any is."""
        while self._has_room():
            task = self.again.popleft() if self.again else next(self._tasks, None)
            if task is None:
                break
            self._furthest = max(self._furthest, task.shard)
            self.under_way[self._sent(task)] = task
        return bool(self.under_way)

    def ended(self) -> list[Future[TaskResult | Path]]:
        """Tasks that have ended, at least one; all of them where one was lost.

        A pool that breaks down loses all its tasks, though not in one instant.
        """
        futures = self.under_way
        while not (ended := wait(futures, timeout=TICK, return_when=FIRST_COMPLETED).done):
            self._count_workers()
        if not self._workers.count or time.monotonic() - self._counted > TICK:
            self._count_workers()  # more may have come
        if any(_is_lost(future, self._workers) for future in ended):
            ended = wait(futures, timeout=TICK).done
        return sorted(ended, key=lambda future: self.under_way[future].shard)

    def _count_workers(self) -> None:
        self._workers.require_alive()
        self._counted = time.monotonic()

    def _has_room(self) -> bool:
        if not self.under_way:
            return True
        if len(self.under_way) >= UNDER_WAY * self._workers.count:
            return False
        if self.again:
            return True
        first = min(task.shard for task in self.under_way.values())
        return self._furthest - first < SPREAD * self._workers.count

    def _sent(self, task: Task) -> Future[TaskResult | Path]:
        try:
            executor, place = self._workers.executor, self._workers.place
            if place is None:
                return executor.submit(perform, task, self._versions)
            return executor.submit(perform_at, place, task, self._versions)
        except self._workers.losses as error:
            lost = Future[TaskResult | Path]()
            lost.set_exception(error)
            return lost


def _is_lost(future: Future[TaskResult | Path], workers: Workers) -> bool:
    if future.cancelled():
        return True
    error = future.exception()
    mistaken = isinstance(error, TypeError) and MISTAKEN in str(error)
    return mistaken or isinstance(error, workers.losses)


def _result(future: Future[TaskResult | Path], task: Task, workers: Workers) -> TaskResult | None:
    """The result of a task; None if its worker died."""
    if _is_lost(future, workers):
        return None
    try:
        result = future.result()
        return result if isinstance(result, TaskResult) else TaskResult.taken_from(result)
    except CertregError:
        raise
    except Exception as error:
        raise CampaignError(
            f"a worker failed on shard {task.shard} ({type(error).__name__}: {shown(error)}): "
            "certreg must be installed, in the same version, wherever workers run",
            shard=task.shard,
        ) from error


def _require_hope(breakdowns: int, lost: deque[Task]) -> None:
    if breakdowns > BREAKDOWNS:
        shards = ", ".join(str(task.shard) for task in lost)
        raise CampaignError(
            f"workers died {breakdowns} times in a row, at work on shards {shards}: is memory too "
            "short for them? What is done is kept: run the same command to go on",
            shard=lost[0].shard if lost else None,
            value=breakdowns,
            limit=BREAKDOWNS,
        )


def _listed(versions: dict[str, str], names: list[str]) -> str:
    return ", ".join(f"{name} {versions.get(name, 'unknown')}" for name in names)


def run(kind: Campaign, folder: Path, workers: Workers, observer: Observer) -> dict[str, float]:
    """Compute what the folder, occupied by this process, lacks; seconds of the workers' time.

    Raises what `completed` raises, and InvalidFileError where a file cannot be written.
    """
    manifest = kind.manifest()
    shards = Shards(folder=folder / SHARDS, identity=manifest.identity(), suffix=kind.suffix)
    for note in shards.drop_damaged():
        observer.noted(note)
    kept, former = _kept(kind, shards, folder), shards.files()
    done = kept.done
    if kept.changed:
        observer.noted(_changed_words(kept.changed))
    observer.begun(sum(len(manifest.items(shard)) for shard in done))
    timings: Counter[str] = Counter()
    for task, result in completed(kind.tasks(done), workers, manifest.versions):
        for name, content in result.files.items():  # not synced: `_kept` sees one that is lost
            write_atomically(folder / CERTIFICATES / name, content, sync=False)
        for name in kept.files.get(task.shard, set()) - result.files.keys():
            (folder / CERTIFICATES / name).unlink(missing_ok=True)
        shards.replace(task.shard, result.content, former.get(task.shard, ()))
        timings.update(result.timings)
        observer.advanced(len(manifest.items(task.shard)))
    return dict(timings)


def contents(kind: Campaign, folder: Path) -> Iterator[bytes]:
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
        raise refused(folder, f"shard {expected} is gone: run the same command again", row=expected)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Kept:
    """What an earlier run left.

    done: shards that are final, of the inputs that are there now, with all the files that go with
    them, and there once. files: those that go with each other shard. changed: inputs, by name.
    """

    done: set[int]
    files: dict[int, set[str]]
    changed: dict[str, None]  # in their order


def _kept(kind: Campaign, shards: Shards, folder: Path) -> _Kept:
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
