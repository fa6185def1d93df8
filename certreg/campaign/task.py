"""The work on a shard, and what comes of it."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from certreg.errors import CampaignError
from certreg.verify import shown

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


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
            message = (
                f"{shown(path)}: a result cannot be handed over ({error.strerror}): free the disk, "
                "or set TMPDIR to a folder on another"
            )
            raise CampaignError(message, path=path) from error
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
