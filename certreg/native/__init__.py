"""The generated code at work: compiled once and cached, or evaluated by CasADi; trajectory loops.

No formula of the dynamics stands here: those are in certreg/native/generated. Handwritten are the
loops around a step, the stop test, and the kick off a saddle.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._faces import lazy_face

if TYPE_CHECKING:
    from certreg.native.batch import ENERGIES as ENERGIES
    from certreg.native.batch import Batch as Batch
    from certreg.native.batch import Ending as Ending
    from certreg.native.batch import Integrator as Integrator
    from certreg.native.batch import Log as Log
    from certreg.native.clouds import ManyClouds as ManyClouds
    from certreg.native.clouds import RestPoses as RestPoses
    from certreg.native.codegen.emit import C_FILE as C_FILE
    from certreg.native.codegen.emit import HEADER_FILE as HEADER_FILE
    from certreg.native.codegen.emit import generated_files as generated_files
    from certreg.native.compiler import GENERATED as GENERATED
    from certreg.native.compiler import HERE as HERE
    from certreg.native.compiler import CompilationError as CompilationError
    from certreg.native.engine import current_engine as current_engine
    from certreg.native.library import Library as Library
    from certreg.native.library import loaded_library as loaded_library

__getattr__ = lazy_face(
    __name__,
    {
        "batch": (
            "Batch",
            "ENERGIES",
            "Ending",
            "Integrator",
            "Log",
        ),
        "clouds": (
            "ManyClouds",
            "RestPoses",
        ),
        "codegen.emit": (
            "C_FILE",
            "HEADER_FILE",
            "generated_files",
        ),
        "compiler": (
            "CompilationError",
            "GENERATED",
            "HERE",
        ),
        "engine": ("current_engine",),
        "library": (
            "Library",
            "loaded_library",
        ),
    },
)
