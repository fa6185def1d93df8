"""Arrays from and to .npy files: header and size must agree, and no pickle is ever run."""

from __future__ import annotations

import io
import math
import tokenize
import warnings
from typing import TYPE_CHECKING, Any, BinaryIO, cast

import numpy as np

from certreg.errors import InvalidFileError
from certreg.files import write_atomically
from certreg.problem import as_doubles
from certreg.verify import shown

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from certreg.simulation import Trajectory

NOT_NPY = (  # what numpy raises for headers that it cannot read
    EOFError,
    MemoryError,
    RecursionError,
    SyntaxError,
    TypeError,
    ValueError,
    tokenize.TokenError,
)


def read_array(file: Path) -> NDArray[np.float64]:
    """The finite doubles of a .npy file, of any shape. Raises InvalidFileError."""
    try:
        with file.open("rb") as stream, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # a header of Python 2 is read right all the same
            declared = _declared_bytes(file, stream)
            held = file.stat().st_size - stream.tell()
            if declared != held:
                message = (
                    f"{file}: the header declares {declared} bytes of data, the file holds "
                    f"{held}: it is truncated or corrupt; save it again"
                )
                raise InvalidFileError(message)
            stream.seek(0)
            array = cast("NDArray[Any]", np.load(stream, allow_pickle=False))
    except OSError as error:
        message = f"{file}: cannot be read ({error.strerror or error}): give a readable file"
        raise InvalidFileError(message) from error
    except NOT_NPY as error:
        message = f"{file}: is not a .npy file ({shown(str(error)[:80])}): save it with numpy.save"
        raise InvalidFileError(message) from error
    return _doubles(file, array)


def write_array(file: Path, array: NDArray[np.float64]) -> None:
    """Write a .npy file, whole or not at all."""
    buffer = io.BytesIO()
    np.save(buffer, array, allow_pickle=False)
    write_atomically(file, buffer.getvalue())


def trajectory_bytes(trajectory: Trajectory) -> bytes:
    """A .npz of a trajectory: times, states (L, 18), potential, kinetic, length_exponent.

    Lengths are over 2^length_exponent, energies per unit of mass over 4^length_exponent.
    """
    buffer = io.BytesIO()
    np.savez_compressed(
        buffer,
        times=trajectory.times,
        states=trajectory.states,
        potential=trajectory.potential,
        kinetic=trajectory.kinetic,
        length_exponent=np.array(trajectory.length_exponent),
    )
    return buffer.getvalue()


def _declared_bytes(file: Path, stream: BinaryIO) -> int:
    """The size of the data that a .npy header declares; the stream is left at the data."""
    version = np.lib.format.read_magic(stream)
    reader = {
        (1, 0): np.lib.format.read_array_header_1_0,
        (2, 0): np.lib.format.read_array_header_2_0,
    }.get(version)
    if reader is None:
        message = f"{file}: npy version {version} is not known: save it again with numpy"
        raise InvalidFileError(message)
    shape, _, dtype = reader(stream)
    if dtype.kind not in "fiu":
        message = f"{file}: holds {dtype}, not real numbers: save float64"
        raise InvalidFileError(message)
    return math.prod(map(int, shape)) * dtype.itemsize


def _doubles(file: Path, array: NDArray[Any]) -> NDArray[np.float64]:
    """The rows of a .npy file as doubles, refused where a value is not finite or would change."""
    doubles, kept = as_doubles(array)
    kept &= np.isfinite(doubles)
    if not kept.all():
        row = int(np.argwhere(~kept)[0][0]) if array.ndim else 0
        message = (
            f"{file}: row {row} (counting from 0) is {np.atleast_1d(array)[row].tolist()}: every "
            "value must be finite and held by a double; remove or round it, in both clouds alike"
        )
        raise InvalidFileError(message)
    return doubles
