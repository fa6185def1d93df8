"""Where and of what a run was made: the machine, its load, the versions, the commit."""

from __future__ import annotations

import os
import platform
import subprocess
from importlib.metadata import version
from pathlib import Path
from typing import Any

import certreg
from build_kernels import BuildError, find_compiler

ROOT = Path(__file__).parent.parent
RESULTS = "benchmarks/results"  # what a run writes is no change of what was measured
CACHES = Path("/sys/devices/system/cpu/cpu0/cache")
UNITS = {"K": 2**10, "M": 2**20}


def machine() -> dict[str, Any]:
    """The processor, its caches and the memory in bytes, the system; null where it is not told."""
    return {
        "cpu": _cpu_model(),
        "cores": os.cpu_count(),
        "caches": _caches(),
        "memory": _memory(),
        "system": platform.platform(),
    }


def load() -> list[float] | None:
    """The load averages of 1, 5 and 15 minutes; None where the system keeps none."""
    return [round(each, 2) for each in os.getloadavg()] if hasattr(os, "getloadavg") else None


def versions() -> dict[str, str | None]:
    """Of certreg, Python, the compiler and the packages that every run needs."""
    return {
        "certreg": certreg.__version__,
        "python": platform.python_version(),
        "compiler": _compiler(),
        **{name: version(name) for name in ("numpy", "scipy", "casadi", "clarabel")},
    }


def commit() -> dict[str, Any] | None:
    """The commit that ran, and whether files differed from it; None outside a repository."""
    try:
        name = _git("rev-parse", "HEAD")
        changes = _git("status", "--porcelain", "--", ".", f":!{RESULTS}")
    except (OSError, subprocess.CalledProcessError):
        return None
    return {"id": name, "changed": bool(changes)}


def _git(*words: str) -> str:
    done = subprocess.run(
        ["git", *words], cwd=ROOT, check=True, capture_output=True, text=True, encoding="utf-8"
    )
    return done.stdout.strip()


def _compiler() -> str | None:
    try:
        return find_compiler().words
    except BuildError:
        return None


def _cpu_model() -> str:
    info = Path("/proc/cpuinfo")
    lines = info.read_text(encoding="utf-8").splitlines() if info.exists() else []
    models = (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    return next(models, platform.processor() or platform.machine())


def _caches() -> dict[str, int]:
    """Bytes of each cache of the first core: L1d, L2, L3."""
    found: dict[str, int] = {}
    for folder in sorted(CACHES.glob("index*")):
        level, kind, size = (
            (folder / name).read_text("ascii").strip() for name in ("level", "type", "size")
        )
        if kind != "Instruction":
            name = f"L{level}d" if kind == "Data" else f"L{level}"
            found[name] = int(size[:-1]) * UNITS[size[-1]]
    return found


def _memory() -> int | None:
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return None
