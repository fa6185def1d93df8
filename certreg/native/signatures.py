"""What ctypes is told of every function of the compiled library that is called: one table.

The generated functions are listed beside the generated code (`SIGNATURES` of kernels.py). A test
reads the prototypes of the headers, and compares. Counts have 64 bits, `int` is for codes and
flags; an address is one of a vector, a record or a number.
"""

from __future__ import annotations

import ctypes
import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from certreg.native.kernels import REMEDY, SIGNATURES, MissingLibraryError

if TYPE_CHECKING:
    from pathlib import Path

_Int, _Long, _Double, _At = ctypes.c_int, ctypes.c_int64, ctypes.c_double, ctypes.c_void_p


@dataclass(frozen=True, slots=True)
class Prototype:
    """The types of a function's result, None for `void`, and of its arguments."""

    result: Any
    arguments: tuple[Any, ...]


WRITTEN = {  # by hand, not generated
    "certreg_agreeing": Prototype(_Long, (_Long, _Long, _At, _At, _At)),
    "certreg_begin": Prototype(None, (_At,)),
    "certreg_cliques": Prototype(_Long, (_At, _Long, _At)),
    "certreg_colours": Prototype(_Long, (_At, _Long)),
    "certreg_cones": Prototype(_Int, (_At,)),
    "certreg_cut": Prototype(None, (_At, _Long, _Long)),
    "certreg_eigenbasis": Prototype(_Int, (_At, _At)),
    "certreg_euler_lanes": Prototype(None, (_At, _At)),
    "certreg_euler_single": Prototype(None, (_At, _At)),
    "certreg_exact_springs": Prototype(_Int, (_Long, _At, _At, _At, _At, _At)),
    "certreg_exact_sums": Prototype(_Int, (_Long, _At, _At, _At, _At, _At)),
    "certreg_few_sums": Prototype(_Int, (_Long, _At, _At, _At, _At, _At)),
    "certreg_fixed_fits": Prototype(_Int, (_Long, _At, _At, _At)),
    "certreg_fixed_sums": Prototype(_Int, (_Long, _At, _At, _At, _At, _At)),
    "certreg_fixed_vectors": Prototype(_Int, ()),
    "certreg_greedy_clique": Prototype(_Long, (_Long, _At, _At, _Long, _At, _At, _At)),
    "certreg_lawson_fits": Prototype(None, (_Long, _At, _Long, _At, _At, _At, _At)),
    "certreg_limb_springs": Prototype(_Int, (_Long, _At, _At, _At, _At, _At)),
    "certreg_many_quartic_paths": Prototype(None, (_Long, _At, _At, _Long, *[_At] * 7)),
    "certreg_many_springs": Prototype(None, (_Long, _Long, *[_At] * 6)),
    "certreg_midpoint_single": Prototype(None, (_At, _At)),
    "certreg_next": Prototype(_Long, (_At,)),
    "certreg_pencil": Prototype(_Int, (_At, _At, _At, _At)),
    "certreg_pose": Prototype(None, (_At, _Int, _At)),
    "certreg_prove_optima": Prototype(None, (_At,)),
    "certreg_quartic_newton": Prototype(_Int, (_At, _At, _At)),
    "certreg_quartic_paths": Prototype(None, (_At, _At, _Long, *[_At] * 6)),
    "certreg_refutation": Prototype(_Long, (_Long, _At, _At, _Long, _At, _At)),
    "certreg_sine": Prototype(_Double, (_Double, _At)),
    "certreg_splitting_lanes": Prototype(None, (_At, _At)),
    "certreg_splitting_single": Prototype(None, (_At, _At)),
    "certreg_spring_midpoint_single": Prototype(None, (_At, _At)),
    "certreg_spring_splitting_lanes": Prototype(None, (_At, _At)),
    "certreg_spring_splitting_single": Prototype(None, (_At, _At)),
    "certreg_springs": Prototype(None, (_Long, *[_At] * 5)),
    "certreg_stationary_poses": Prototype(None, (_At,)),
    "certreg_strike": Prototype(None, (_At, _Long)),
    "certreg_strike_by_colours": Prototype(_Long, (_At, _At)),
    "certreg_sums": Prototype(None, (_At, _At, _At)),
    "certreg_thin": Prototype(None, (_At,)),
    "certreg_triangles": Prototype(None, (_Long, _At, _At, _At)),
}


@dataclass(frozen=True, slots=True)
class Signature:
    """Sizes of the arguments and results of a generated function."""

    arguments: tuple[int, ...]
    results: tuple[int, ...]


def generated() -> dict[str, Signature]:
    """The generated functions and the sizes of their arguments, as the generator wrote them."""
    return {
        name: Signature(tuple(sizes["arguments"]), tuple(sizes["results"]))
        for path in SIGNATURES
        for name, sizes in json.loads(path.read_text("utf-8")).items()
    }


def prototypes() -> dict[str, Prototype]:
    """Of every function that is called."""
    made = {
        name: Prototype(None, (_At,) * (len(sizes.arguments) + len(sizes.results)))
        for name, sizes in generated().items()
    }
    return WRITTEN | made


def opened(path: Path) -> Any:
    """A library that is told its prototypes. Raises MissingLibraryError."""
    try:
        handle = ctypes.CDLL(str(path))
    except OSError as error:
        raise MissingLibraryError(f"{path} cannot be loaded ({error}): {REMEDY}") from error
    for name, prototype in prototypes().items():
        if not hasattr(handle, name):
            raise MissingLibraryError(f"{path} lacks {name}: {REMEDY}")
        function = getattr(handle, name)
        function.argtypes, function.restype = prototype.arguments, prototype.result
    return handle
