"""Arrays that are files: known as such, and let go of after use.

What a mapped array has shown of its file stays in memory until it is let go of; the system keeps
the file's pages where it likes, so that nothing is lost by that but the place.
"""

from __future__ import annotations

import mmap
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from numpy.typing import NDArray

AROUND = 1 << 21  # bytes: with a page the system may show the rest of a huge page
DONT_NEED: int | None = getattr(mmap, "MADV_DONTNEED", None)  # not on Windows


def mapped_file(array: NDArray[Any]) -> mmap.mmap | None:
    """The file of an array that was mapped for reading only; None for any other array.

    Through a map for reading only this process cannot change the array.
    """
    owner: Any = array
    while owner is not None and not isinstance(owner, mmap.mmap):
        owner = owner.obj if isinstance(owner, memoryview) else getattr(owner, "base", None)
    return owner if owner is not None and memoryview(owner).readonly else None


def let_go(array: NDArray[Any]) -> None:
    """Give back the memory in which the system shows the part of a file that an array views.

    And of what lies around it, which the system has shown, too: of two threads that read parts side
    by side the later one clears up between them. The array stays as it is; nothing happens to one
    that is not mapped for reading only.
    """
    file = mapped_file(array)
    if file is None or DONT_NEED is None or array.size == 0:
        return
    first = _address(file)
    low, high = _bounds(array)
    start = max(0, low - first - AROUND) // mmap.PAGESIZE * mmap.PAGESIZE
    file.madvise(DONT_NEED, start, min(high - first + AROUND, len(file)) - start)


def _address(file: mmap.mmap) -> int:
    import numpy as np

    return np.frombuffer(file, dtype=np.uint8).ctypes.data


def _bounds(array: NDArray[Any]) -> tuple[int, int]:
    """Addresses of the first byte and behind the last one."""
    reaches = [(n - 1) * step for n, step in zip(array.shape, array.strides, strict=True)]
    low = array.ctypes.data + sum(reach for reach in reaches if reach < 0)
    high = array.ctypes.data + sum(reach for reach in reaches if reach > 0) + array.itemsize
    return low, high
