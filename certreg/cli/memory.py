"""Whether the libraries that compute load under this process's limit on memory.

Under a limit (`ulimit -v`, many batch systems) OpenBLAS may hang while it is loaded, raise SIGINT,
or end the process with code 1, which here means "refused". No exception says so. So where the limit
may be too low, a process of its own loads the libraries first, within a bounded time; only if it
comes to its end does this one load them, the same ones in the same order, before it reads any data.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence

from certreg.errors import MissingToolError

# What loading takes at most, in bytes: measured 450 MB with two processors, of which 100 MB are for
# the buffers of each; twice that, and more for the libraries themselves.
BASE, EACH_PROCESSOR = 1 << 30, 1 << 28
RESERVE = 1 << 27  # bytes for the command itself, its data and later calls: measured 60 MB
PATIENCE = 30.0  # seconds for what takes two; a cold disk takes ten
LIMITED = "import resource; resource.setrlimit(resource.RLIMIT_AS, ({0}, {0}))\n"
# A product in each library: its buffers are taken when it is first called.
LOADING = """
import numpy
numpy.ones((64, 64)) @ numpy.ones((64, 64))
"""
LOADING_ALL = f"""{LOADING}
try:
    import clarabel, scipy.linalg
    scipy.linalg.eigh(numpy.eye(64))
except ModuleNotFoundError:
    pass  # not installed: `certify` says so itself
"""


def require_loadable(loading: str) -> None:
    """Run `loading`, but first, under a limit on memory, in a process of its own.

    Raises MissingToolError where that does not come to its end.
    """
    limit = memory_limit()
    if limit is None or limit >= BASE + EACH_PROCESSOR * (os.cpu_count() or 1):
        return
    limited = LIMITED.format(max(0, limit - RESERVE))
    if not _succeeds([sys.executable, "-c", limited + loading]):
        raise MissingToolError(
            f"the {limit >> 20} MB of memory that this process may use are too few to load NumPy "
            "and what else computes: raise the limit (ulimit -v), or set OPENBLAS_NUM_THREADS=1",
            tool="numpy",
        )
    exec(loading, {})  # noqa: S102 - a constant of this module


def memory_limit() -> int | None:
    """The bytes of address space that this process may use, None without a limit."""
    try:
        import resource  # Windows has none
    except ImportError:
        return None
    soft = resource.getrlimit(resource.RLIMIT_AS)[0]
    return None if soft == resource.RLIM_INFINITY else soft


def _succeeds(command: Sequence[str]) -> bool:
    try:
        done = subprocess.run(  # noqa: S603 - this Python, our own code
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=PATIENCE,
            check=False,
        )
    except (subprocess.TimeoutExpired, OSError):
        return False
    return done.returncode == 0
