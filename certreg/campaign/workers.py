"""Where a campaign is computed: processes of this machine, or a dask cluster.

Both are a `concurrent.futures.Executor`. Local workers are born with a pipe to this process and end
at once when its other end closes, so none outlives a campaign that is killed. They hand their
results over in files: a worker that dies in the middle of a long message leaves the half of it in
the pool's pipe, and the pool waits for the rest for ever. A short one is sent whole or not at all.
"""

from __future__ import annotations

import json
import logging
import multiprocessing
import os
import signal
import tempfile
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, CancelledError, Executor, ProcessPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from certreg._loading import library
from certreg.campaign.store import lockable, try_lock
from certreg.certificate.private_folder import sweep
from certreg.errors import CampaignError
from certreg.verify import shown

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

LOG = logging.getLogger(__name__)
CONNECTING = 15.0  # seconds for a scheduler to answer
RESULTS = "certreg-results-"  # how names of folders begin in which workers leave results
PATIENCE = 60.0  # seconds without any worker


class Workers(ABC):
    """Some workers behind an executor.

    losses: what a future raises whose worker died; count: how many tasks are worked on at once, as
    last seen, 0 before there was a worker.
    place: the folder in which they leave their results; None where these travel by themselves.
    """

    executor: Executor
    place: Path | None = None
    losses: tuple[type[BaseException], ...]
    count: int

    @abstractmethod
    def require_alive(self) -> None:
        """Count anew; raises CampaignError where no worker is left to wait for."""

    @abstractmethod
    def renew(self) -> None:
        """Replace what broke down; all tasks under way are lost."""

    def __enter__(self) -> Self:
        return self

    @abstractmethod
    def __exit__(self, *_: object) -> None: ...


class LocalWorkers(Workers):
    """Processes of this machine, as many as it lets us use processors."""

    losses: tuple[type[BaseException], ...] = (BrokenExecutor,)

    def __init__(self, count: int | None = None) -> None:
        self.count = count or _processors()
        self._open()

    def _open(self) -> None:
        context = multiprocessing.get_context("spawn")  # a fork would inherit locks of our threads
        self._reader, self._lifeline = context.Pipe(duplex=False)
        sweep(Path(tempfile.gettempdir()), RESULTS, _is_abandoned)
        self._folder = tempfile.TemporaryDirectory(prefix=RESULTS)
        self.place = Path(self._folder.name)
        self._held = lockable(self.place)
        with suppress(OSError):  # this disk has no locks
            try_lock(self._held)
        self.executor: Executor = ProcessPoolExecutor(
            self.count, mp_context=context, initializer=_end_with, initargs=(self._reader,)
        )

    def require_alive(self) -> None:
        """Nothing: the pool sees a death by itself, as no message is so long that half is sent."""

    def renew(self) -> None:
        """A new pool of processes in place of the old one."""
        self._close()
        self._open()

    def _close(self) -> None:
        """End the processes now, whatever they are doing."""
        self._lifeline.close()
        self.executor.shutdown(wait=True, cancel_futures=True)
        self._reader.close()
        os.close(self._held)
        self._folder.cleanup()

    def __exit__(self, *_: object) -> None:
        self._close()


class ClusterWorkers(Workers):
    """The workers of a dask scheduler at an address, as `dask scheduler` prints it.

    Workers may come and go; dask itself repeats the tasks of those that die.
    """

    def __init__(self, address: str) -> None:
        self._client = _connected(address, CONNECTING)
        self._address = shown(address)
        self._last_seen, self._told = time.monotonic(), False
        self.losses: tuple[type[BaseException], ...] = (CancelledError, _killed_worker())
        self.executor: Executor = self._client.get_executor(pure=False)
        self.count = self._threads()

    def require_alive(self) -> None:
        """Count the workers, and log once that there are none.

        Raises CampaignError where there have been none for a minute.
        """
        threads, now = self._threads(), time.monotonic()
        nobody = f"the scheduler at {self._address} has no workers"
        remedy = f"start some with `dask worker {self._address}`"
        if threads:
            self.count, self._last_seen, self._told = threads, now, False
        elif now - self._last_seen > PATIENCE:
            raise CampaignError(f"{nobody}: {remedy}", address=self._address)
        elif not self._told:
            self._told = True
            LOG.warning("%s: waiting %.0f seconds for one: %s", nobody, PATIENCE, remedy)

    def _threads(self) -> int:
        try:
            threads: dict[str, int] = self._client.nthreads()
        except (OSError, TimeoutError) as error:
            raise CampaignError(
                f"the scheduler at {self._address} is gone: start it, and run the same again",
                address=self._address,
            ) from error
        return sum(threads.values())

    def renew(self) -> None:
        """The scheduler replaces workers itself, where it can: only see who is there."""
        self.require_alive()

    def __exit__(self, *_: object) -> None:
        with suppress(OSError, TimeoutError):
            self.executor.shutdown(wait=False)
            self._client.close()


def workers_at(scheduler: str | None) -> Workers:
    """The workers of a scheduler, or of this machine where none is given."""
    return LocalWorkers() if scheduler is None else ClusterWorkers(scheduler)


def _connected(address: str, timeout: float) -> Any:
    distributed = library("distributed", "--scheduler")
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what it logs is raised, too
    try:
        return distributed.Client(address, timeout=timeout, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise CampaignError(
            f"no dask scheduler answers at {shown(address)}: start one with `dask scheduler` and "
            "give the address that it prints",
            address=address,
        ) from error


def _killed_worker() -> type[BaseException]:
    killed: type[BaseException] = library("distributed", "--scheduler").KilledWorker
    return killed


def _is_abandoned(folder: Path) -> bool:
    """Whether no process holds the results of workers. Raises OSError where there are no locks."""
    handle = lockable(folder)
    try:
        return try_lock(handle)
    finally:
        os.close(handle)


def _processors() -> int:
    """How many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _end_with(lifeline: Connection) -> None:
    """Bind a worker to its campaign: it leaves Ctrl-C to it, and ends when it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def stay() -> None:
        with suppress(OSError):
            lifeline.poll(None)  # nothing is ever sent: it returns when the other end closes
        os._exit(1)

    threading.Thread(target=stay, daemon=True).start()


@dataclass(frozen=True, slots=True, kw_only=True)
class TaskResult:
    """Of a task: the content of the shard, files that go with it, and what the work took.

    files: content by name. timings: seconds by what they were spent on.
    """

    content: bytes
    files: dict[str, bytes] = field(default_factory=dict[str, bytes])
    timings: dict[str, float] = field(default_factory=dict[str, float])

    def left_at(self, path: Path) -> Path:
        """The path, at which the result now stands. Raises CampaignError where it cannot."""
        sizes = {name: len(content) for name, content in self.files.items()}
        header = json.dumps({"content": len(self.content), "files": sizes, "timings": self.timings})
        try:
            with path.open("xb") as stream:
                stream.writelines((header.encode(), b"\n", self.content, *self.files.values()))
        except OSError as error:
            raise CampaignError(
                f"{shown(path)}: a result cannot be handed over ({error.strerror}): free the disk, "
                "or set TMPDIR to a folder on another",
                path=path,
            ) from error
        return path

    @classmethod
    def taken_from(cls, path: Path) -> TaskResult:
        """The result that was left there; the file goes."""
        with path.open("rb") as stream:
            header = json.loads(stream.readline())
            content = stream.read(header["content"])
            files = {name: stream.read(size) for name, size in header["files"].items()}
        path.unlink()
        return cls(content=content, files=files, timings=header["timings"])


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """The work on one shard: a function of a module and its keywords, to be sent to a worker."""

    shard: int
    function: Callable[..., TaskResult]
    arguments: dict[str, Any]
