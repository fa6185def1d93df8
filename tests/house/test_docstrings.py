"""What an editor shows of a public name: numpydoc's sections, and they are those of the code."""

from __future__ import annotations

import builtins
import inspect
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any

import pytest

import certreg
from certreg import errors

if TYPE_CHECKING:
    from collections.abc import Iterator

ORDER = ("Parameters", "Attributes", "Returns", "Raises", "Examples")
MADE_BY_USERS = {
    *("AssessmentSettings", "Pose", "RegistrationProblem", "Similarity", "SimulationSettings")
}
NAMES = [name for name in certreg.__all__ if name != "__version__"]


def sections(docstring: str) -> dict[str, list[str]]:
    """The lines of each section, in their order; what stands above the first is named ``."""
    found: dict[str, list[str]] = {"": []}
    lines = inspect.cleandoc(docstring).splitlines()
    for line, below in zip(lines, [*lines[1:], ""], strict=True):
        if below and set(below) == {"-"}:
            assert len(below) == len(line), line
            assert line not in found, line
            found[line] = []
        elif not line or set(line) != {"-"}:
            found[[*found][-1]].append(line)
    return found


def entries(lines: list[str]) -> list[str]:
    """The names of a section, one by one; each has a description."""
    filled = [line for line in lines if line]
    heads = [k for k, line in enumerate(filled) if not line.startswith(" ")]
    assert all(filled[k + 1].startswith("    ") for k in heads)
    return [name for k in heads for name in filled[k].split(", ")]


def members(name: str) -> Iterator[tuple[str, Any]]:
    """A public name, and the public methods of a class, those that certreg wrote."""
    public: Any = getattr(certreg, name)
    yield name, public
    for each in dir(public) if inspect.isclass(public) else ():
        method = inspect.getattr_static(public, each)
        method = getattr(method, "__func__", method)
        if not each.startswith("_") and inspect.isfunction(method):
            yield f"{name}.{each}", method


def arguments(function: Any) -> list[str]:
    """As a section names them: without self and cls, with the stars of the rest."""
    stars = {inspect.Parameter.VAR_POSITIONAL: "*", inspect.Parameter.VAR_KEYWORD: "**"}
    return [
        stars.get(parameter.kind, "") + name
        for name, parameter in inspect.signature(function).parameters.items()
        if name not in {"self", "cls"}
    ]


def faults(function: Any) -> list[str]:
    """What the sections of a function lack, or say too much."""
    told = sections(function.__doc__)
    described = entries(told.get("Parameters", []))
    returned = inspect.signature(function).return_annotation
    found = [name for name in told if name and name not in ORDER]
    found += ["order"] if [*told][1:] != [name for name in ORDER if name in told] else []
    if sorted(described) != sorted(arguments(function)):
        found.append(f"Parameters: {described}, not {arguments(function)}")
    if described and (returned != "None") != ("Returns" in told):
        found.append("Returns")  # where there is nothing to give, the first line says what comes
    found += [
        name
        for name in entries(told.get("Raises", []))
        if not hasattr(errors, name) and not hasattr(builtins, name)
    ]
    prose = " ".join("\n".join(told[""]).split())
    found += [word for word in ("Raises", "raises") if word in prose]
    return found


def faults_of_class(kind: Any) -> list[str]:
    told = sections(kind.__doc__)
    section = "Parameters" if kind.__name__ in MADE_BY_USERS else "Attributes"
    if section == "Parameters":
        names = arguments(kind)
    else:
        names = [each.name for each in fields(kind)] if is_dataclass(kind) else []
        names = [name for name in names if not name.startswith("_")]
    described = entries(told.get(section, []))
    found = [name for name in told if name and name not in ORDER]
    return found + sorted(set(described) ^ set(names))


@pytest.mark.parametrize("name", NAMES)
def test_the_sections_of_a_docstring_are_those_of_the_signature(name: str):
    for full, public in members(name):
        found = faults_of_class(public) if inspect.isclass(public) else faults(public)

        assert found == [], full


def test_every_public_function_describes_its_arguments():
    """So the question above finds something."""
    functions = [public for name in NAMES for _, public in members(name) if callable(public)]
    described = [each for each in functions if "Parameters\n" in (each.__doc__ or "")]

    assert len(described) > 25


def test_what_sections_lack_is_seen():
    def good(a: int, *, b: int = 0, **c: int) -> int:
        """One.

        Parameters
        ----------
        a, b
            Numbers.
        **c
            More.

        Returns
        -------
        int
            Their sum.

        Raises
        ------
        ValueError, CertregError
            Never.
        """
        return a + b + sum(c.values())

    def changed(old: str, new: str) -> list[str]:
        def other(a: int, *, b: int = 0, **c: int) -> int:
            return a + b + sum(c.values())

        assert old in str(good.__doc__)
        other.__doc__ = str(good.__doc__).replace(old, new)
        return faults(other)

    assert faults(good) == []
    for old, new in (
        ("a, b", "a"),
        ("a, b", "a, b, d"),
        ("**c", "c"),
        ("Returns\n        -------\n        int\n            Their sum.\n", ""),
        ("ValueError", "NoSuchError"),
        ("One.", "One. Raises ValueError."),
        ("Raises\n        ------", "Errors\n        ------"),
    ):
        assert changed(old, new) != [], (old, new)
