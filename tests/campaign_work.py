"""Workers and work for the tests of campaigns; importable where a worker process looks for it."""

from __future__ import annotations

import os
import signal
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, Any

from certreg.campaign.runner import Observer, run
from certreg.campaign.store import Manifest, current_versions, occupied
from certreg.campaign.workers import Task, TaskResult, Workers
from certreg.paper.monte_carlo import MonteCarlo

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

VERSIONS = current_versions()


class Cut(MonteCarlo):
    """The same in shards of ten."""

    def manifest(self) -> Manifest:
        return replace(super().manifest(), shard_size=10)


class InProcess(Workers):
    """Workers that are threads of this process: no start-up, same interface."""

    losses: tuple[type[BaseException], ...] = (BrokenExecutor,)

    def __init__(self, count: int = 1) -> None:
        self.count, self.renewals = count, 0
        self.executor: Executor = ThreadPoolExecutor(count)

    def require_alive(self) -> None: ...

    def renew(self) -> None:
        self.renewals += 1

    def __exit__(self, *_: object) -> None:
        self.executor.shutdown()


class Fragile(Executor):
    """Breaks down at every call whose turn is among `deaths`, counted over all calls."""

    def __init__(self, deaths: set[int]) -> None:
        self.deaths, self.sent = deaths, 0

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future = Future[Any]()
        if self.sent in self.deaths:
            future.set_exception(BrokenExecutor("a worker was killed"))
        else:
            future.set_result(fn(*args, **kwargs))
        self.sent += 1
        return future


def echo(*, words: str) -> TaskResult:
    return TaskResult(content=words.encode())


def numbered(count: int) -> Iterator[Task]:
    return (Task(shard=k, function=echo, arguments={"words": str(k)}) for k in range(count))


MESSAGES: list[int] = []  # the bytes of each that this process has sent


def record_messages() -> None:
    """From now on."""
    send = Connection._send  # pyright: ignore[reportAttributeAccessIssue]

    def recorded(self: Connection, content: bytes) -> None:
        MESSAGES.append(len(content))
        send(self, content)

    Connection._send = recorded  # pyright: ignore[reportAttributeAccessIssue]


def longest_message() -> int:
    return max(MESSAGES)


def large(*, size: int) -> TaskResult:
    """A result of many bytes in 300 files."""
    files = {f"{k:08d}.json": bytes([k % 256]) * (size // 300) for k in range(300)}
    return TaskResult(content=b"all\n" * (size // 4), files=files, timings={"drawing": 0.1})


def fail_far_down(*, depth: int) -> TaskResult:
    """Fails below two functions in turn: Python shortens the traceback of one that calls itself."""

    def further() -> TaskResult:
        return fail_far_down(depth=depth - 1)

    if depth:
        return further()
    message = "far down"
    raise ValueError(message)


def die_once(*, folder: str, words: str) -> TaskResult:
    """Kills the process that it runs in, the first time that it is called with a folder."""
    marker = Path(folder) / f"died-{words}"
    if not marker.exists():
        marker.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return TaskResult(content=words.encode())


def finish(
    kind: Any, folder: Path, workers: Any = None, advanced: Callable[[int], None] = lambda _: None
) -> list[str]:
    """A campaign run to its end in this process; the notes it gave."""
    notes: list[str] = []
    observer = Observer(begun=lambda _: None, advanced=advanced, noted=notes.append)
    with workers or InProcess() as crew, occupied(folder, kind.manifest()):
        run(kind, folder, crew, observer)
    return notes


def tree(folder: Path) -> dict[str, bytes]:
    """Every file below a folder, by its path from there."""
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}
