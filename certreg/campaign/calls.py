"""Calls carried out by workers: a bounded number under way, those of dead workers repeated."""

from __future__ import annotations

from collections import deque
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from certreg.campaign.manifest import current_versions
from certreg.errors import (
    CampaignError,
    CertregError,
    ContradictionError,
    RefusedCertificateError,
)
from certreg.settings import CampaignSettings
from certreg.verify import shown

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator

    from certreg.campaign.workers import Workers


@dataclass(frozen=True, slots=True, kw_only=True)
class Yield:
    """What a call gives: the content of a shard, files that go with it, and what the work took.

    files: content by name. timings: seconds by what they were spent on.
    """

    content: bytes
    files: dict[str, bytes] = field(default_factory=dict[str, bytes])
    timings: dict[str, float] = field(default_factory=dict[str, float])


@dataclass(frozen=True, slots=True, kw_only=True)
class Call:
    """The work on one shard: a function of a module and its keywords, to be sent to a worker."""

    shard: int
    function: Callable[..., Yield]
    arguments: dict[str, Any]


def outcomes(
    calls: Iterator[Call], workers: Workers, versions: dict[str, str]
) -> Generator[tuple[Call, Yield]]:
    """Calls with what they gave, as they end; they come in order of their shards.

    A bounded number is under way, and none far ahead of the first of them: calls are drawn, and
    results held, no faster than asked for. Raises CampaignError where workers keep dying, fail, or
    have other versions than `versions`; ContradictionError where certreg contradicts itself. What
    is under way then ends with the workers.
    """
    desk, breakdowns = _Desk(calls, workers, versions), 0
    while desk.fill():
        for future in desk.ended():
            call = desk.under_way.pop(future)
            found = _result(future, call, workers)
            if found is None:
                desk.again.append(call)
            else:
                breakdowns = 0
                yield call, found
        if desk.again:
            breakdowns += 1
            _require_hope(breakdowns, desk.again)
            workers.renew()


def in_order(found: Iterable[tuple[Call, Yield]]) -> Iterator[Yield]:
    """What calls gave in the order of their shards, from shard 0 on without a gap."""
    early: dict[int, Yield] = {}
    due = 0
    for call, result in found:
        early[call.shard] = result
        while due in early:
            yield early.pop(due)
            due += 1


def performed(call: Call, versions: dict[str, str]) -> Yield:
    """A call carried out in this process, a worker's, if it is of the campaign's versions."""
    here = current_versions()
    if here != versions:
        message = (
            f"a worker has {_listed(here)}, the campaign {_listed(versions)}: "
            "install the same everywhere"
        )
        raise CampaignError(message)
    try:
        return call.function(**call.arguments)
    except RefusedCertificateError as error:  # holds a verdict: does not travel between processes
        raise ContradictionError(str(error)) from None


class _Desk:
    """What is under way, what is to be done again, and what has not been begun."""

    def __init__(self, calls: Iterator[Call], workers: Workers, versions: dict[str, str]) -> None:
        self.under_way: dict[Future[Yield], Call] = {}
        self.again: deque[Call] = deque()
        self._calls, self._workers, self._versions = calls, workers, versions
        self._furthest = -1

    def fill(self) -> bool:
        """Send calls to the workers until enough are under way; whether any is."""
        while self._has_room():
            call = self.again.popleft() if self.again else next(self._calls, None)
            if call is None:
                break
            self._furthest = max(self._furthest, call.shard)
            self.under_way[self._sent(call)] = call
        return bool(self.under_way)

    def ended(self) -> list[Future[Yield]]:
        """Calls that have ended, at least one; all of them where one was lost.

        A pool that breaks down loses all its calls, though not in one instant.
        """
        tick, all_of_them = CampaignSettings().tick, self.under_way
        while not (found := wait(all_of_them, timeout=tick, return_when=FIRST_COMPLETED).done):
            self._workers.require_alive()
        if any(_is_lost(future, self._workers) for future in found):
            found = wait(all_of_them, timeout=tick).done
        return sorted(found, key=lambda future: self.under_way[future].shard)

    def _has_room(self) -> bool:
        settings = CampaignSettings()
        if len(self.under_way) >= settings.under_way * self._workers.count:
            return False
        if self.again or not self.under_way:
            return True
        first = min(call.shard for call in self.under_way.values())
        return self._furthest - first < settings.spread * self._workers.count

    def _sent(self, call: Call) -> Future[Yield]:
        try:
            return self._workers.executor.submit(performed, call, self._versions)
        except self._workers.losses as error:
            lost = Future[Yield]()
            lost.set_exception(error)
            return lost


def _is_lost(future: Future[Yield], workers: Workers) -> bool:
    return future.cancelled() or isinstance(future.exception(), workers.losses)


def _result(future: Future[Yield], call: Call, workers: Workers) -> Yield | None:
    """What a call gave; None if its worker died."""
    if _is_lost(future, workers):
        return None
    try:
        return future.result()
    except CertregError:
        raise
    except Exception as error:
        message = (
            f"a worker failed on shard {call.shard} ({type(error).__name__}: {shown(error)}): "
            "certreg must be installed, in the same version, wherever workers run"
        )
        raise CampaignError(message) from error


def _require_hope(breakdowns: int, lost: deque[Call]) -> None:
    if breakdowns > CampaignSettings().breakdowns:
        shards = ", ".join(str(call.shard) for call in lost)
        message = (
            f"workers died {breakdowns} times in a row, at work on shards {shards}: is memory too "
            "short for them? What is done is kept: run the same command to go on"
        )
        raise CampaignError(message)


def _listed(versions: dict[str, str]) -> str:
    return ", ".join(f"{name} {version}" for name, version in versions.items())
