"""The face of a package: its public names, each imported when it is first used."""

from __future__ import annotations

import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence


def lazy_face(package: str, names: Mapping[str, Sequence[str]]) -> Callable[[str], Any]:
    """The `__getattr__` of a package (PEP 562) that shows names of the modules inside it.

    names: by module, relative to the package. Heavy libraries are so loaded by those alone who use
    them, and a package may be imported before the modules that its own modules need.
    """
    homes = {name: f"{package}.{module}" for module, shown in names.items() for name in shown}

    def __getattr__(name: str) -> Any:  # noqa: N807 - it is one, of the package
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = getattr(import_module(homes[name]), name)
        setattr(sys.modules[package], name, value)
        return value

    return __getattr__


def found_late(module: str, name: str) -> Callable[[], Any]:
    """A function that gives a name of a module, imported when it is first asked for."""
    return lambda: getattr(import_module(module), name)
