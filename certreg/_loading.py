"""What is had when it is first asked for: public names, modules, libraries of others, properties.

A library that is not installed is told from one that is and does not load: the remedies differ.
"""

from __future__ import annotations

import functools
import shlex
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from traceback import walk_tb
from typing import TYPE_CHECKING, Any

from certreg.errors import MissingToolError

if TYPE_CHECKING or sys.version_info >= (3, 12):
    cached_property = functools.cached_property
else:

    class cached_property(functools.cached_property):  # noqa: N801 - of that name
        """As from Python 3.12 on: without a lock, which takes longer than many a property.

        Two threads may both compute a value: it is the same, of an object that does not change.
        """

        def __get__(self, instance: Any, owner: Any = None) -> Any:
            if instance is None:
                return self
            value = instance.__dict__[self.attrname] = self.func(instance)
            return value


def lazy_face(package: str, names: Mapping[str, Sequence[str]]) -> Callable[[str], Any]:
    """The `__getattr__` of a package (PEP 562) that shows names of the modules inside it.

    names: by module, relative to the package. Heavy libraries are so loaded by those alone who use
    them.
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
    return functools.cache(lambda: getattr(import_module(module), name))


class LateModule:
    """A module that is imported when one of its names is first asked for."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, name: str) -> Any:
        return getattr(import_module(self._name), name)


def late(module: str) -> Any:
    """A module that is imported when one of its names is first asked for.

    For places that choose between kinds of problems or files, most of which a process never sees,
    and for what is heavy:

        if TYPE_CHECKING:
            from certreg.registration import truncated
        else:
            truncated = late("certreg.registration.truncated")
    """
    return LateModule(module)


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a library comes from.

    package: its name in the package index. extra: of certreg, that brings it; None: certreg itself.
    """

    package: str
    extra: str | None = None

    @property
    def name(self) -> str:
        """The package without what it may bring beside itself."""
        return self.package.partition("[")[0]

    @property
    def remedy(self) -> str:
        """What to type where it is not installed."""
        if self.extra is None:
            return f"pip install {self.package}"
        if self.extra == "files":  # each reads one format, and one of them is large
            return f"pip install {shlex.quote(self.package)} (extra `files`)"
        return f"pip install 'certreg[{self.extra}]'"


ORIGINS = {  # by the name under which Python knows it; as pyproject.toml has them
    "numpy": Origin("numpy"),
    "click": Origin("click"),
    "jinja2": Origin("jinja2"),
    "scipy": Origin("scipy"),
    "clarabel": Origin("clarabel"),
    "filelock": Origin("filelock"),
    "flint": Origin("python-flint"),
    "sympy": Origin("sympy", "derive"),
    "casadi": Origin("casadi", "derive"),
    "cvxpy": Origin("cvxpy-base", "derive"),
    "matplotlib": Origin("matplotlib", "figures"),
    "distributed": Origin("distributed", "campaign"),
    "pyarrow": Origin("pyarrow", "parquet"),
    "gemmi": Origin("gemmi", "files"),
    "laspy": Origin("laspy[lazrs]", "files"),
    "pye57": Origin("pye57", "files"),
}


def library(module: str, purpose: str, otherwise: str = "") -> Any:
    """A module of a library in `ORIGINS`, loaded now. Raises MissingToolError.

    purpose: what needs it, the subject of the message. otherwise: what else helps, its end.
    """
    try:
        return import_module(module)
    except Exception as error:
        # Whatever stops a library while it loads, a wrong NumPy or a lost file: it is broken.
        raise refusal(module, error, purpose, otherwise) from error


def require(*modules: str, purpose: str) -> None:
    """That libraries of extras load, before anything is computed for which they are needed."""
    missing = [module for module in modules if not _installed(module)]
    if len(missing) > 1:
        origins = [ORIGINS[module] for module in missing]
        names = " and ".join(origin.name for origin in origins)
        extras = ",".join(dict.fromkeys(origin.extra for origin in origins if origin.extra))
        raise MissingToolError(
            f"{purpose} needs {names}, which are not installed: pip install 'certreg[{extras}]'",
            tool=missing[0],
        )
    for module in modules:
        library(module, purpose)


def refusal(module: str, error: Exception, purpose: str, otherwise: str = "") -> MissingToolError:
    """What is said where a module of a library in `ORIGINS` could not be loaded."""
    name = _root(module)
    if isinstance(error, ModuleNotFoundError):  # of the library, or of one that it needs itself
        name = belongs(error) or name
    origin = ORIGINS[name]
    if isinstance(error, ModuleNotFoundError) and not _installed(name):
        fault = f"is not installed: {origin.remedy}"
    else:
        words = " ".join(str(error).split()) or "no reason given"
        fault = (
            f"is installed but does not load ({type(error).__name__}: {words}): "
            f"pip install --force-reinstall {origin.name}"
        )
    return MissingToolError(f"{purpose} needs {origin.name}, which {fault}{otherwise}", tool=name)


def belongs(error: ImportError) -> str | None:
    """The library in `ORIGINS` that an import missed, None if it is another one."""
    name = _root(error.name or "")
    return name if name in ORIGINS else None


def unloaded(error: Exception) -> str | None:
    """The library in `ORIGINS` that an exception kept from loading, None where it is another fault.

    Either the import missed it, or its own modules were being run: the innermost of them is named.
    """
    missed = belongs(error) if isinstance(error, ImportError) else None
    frames = [frame for frame, _ in walk_tb(error.__traceback__)]
    run = [
        _root(frame.f_globals.get("__name__", ""))
        for frame in frames
        if frame.f_code.co_name == "<module>"
    ]
    return missed or next((name for name in reversed(run) if name in ORIGINS), None)


def _installed(name: str) -> bool:
    """Whether a library is there at all, although a file of it may be lost."""
    try:
        return find_spec(name) is not None
    except (ImportError, ValueError):
        return False


def _root(module: str) -> str:
    return module.partition(".")[0]
