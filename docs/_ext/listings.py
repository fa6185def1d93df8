"""The code behind a claim: a dotted name becomes a link, with the source of what is short."""

from __future__ import annotations

import importlib
import inspect
import textwrap
from typing import Any

from disclosure import Disclosure, Summary
from docutils import nodes
from sphinx import addnodes
from sphinx.util import logging

logger = logging.getLogger(__name__)
PUBLIC_MODULE = "verify"  # also a function: the name leads to the module
LONGEST = 45  # lines of source that are shown on the page of a proof


def resolve(dotted: str) -> Any:
    """The object of a dotted name, from the module that defines it. Raises ValueError."""
    parts = dotted.split(".")
    for cut in range(len(parts), 0, -1):
        try:
            found: Any = importlib.import_module(".".join(parts[:cut]))
        except ModuleNotFoundError:
            continue
        try:
            for name in parts[cut:]:
                found = getattr(found, name)
        except AttributeError:
            break
        return found
    raise ValueError(f"no code is called {dotted}")


def listing(dotted: str, docname: str) -> nodes.Element:
    """A link to the reference of a dotted name, over its source if that is short.

    A name that no code bears is a warning, and so fails the build.
    """
    try:
        found = resolve(dotted)
    except ValueError as error:
        logger.warning("%s", error, location=docname)
        return nodes.paragraph("", "", nodes.literal(text=dotted), classes=["listing"])
    link = reference_to(dotted, docname)
    source = _source(found)
    if source is None or source.count("\n") > LONGEST:
        return nodes.paragraph("", "", link, classes=["listing"])
    block = nodes.literal_block(source, source, language="python")
    return Disclosure("", Summary("", "", link), block, classes=["listing"])


def reference_to(dotted: str, docname: str) -> nodes.Element:
    """A link to where the reference describes a dotted name; plain where it does not."""
    name = nodes.literal(text=dotted, classes=["xref", "py"])
    if any(part.startswith("_") for part in dotted.split(".")):
        return name
    kind = "mod" if inspect.ismodule(resolve(dotted)) else "obj"
    link = addnodes.pending_xref(
        "",
        refdomain="py",
        reftype=kind,
        reftarget=_described(dotted),
        refdoc=docname,
        refexplicit=False,
    )
    link += name
    return link


def public_homes() -> dict[str, str]:
    """The public names that have a description of their own, and the modules they come from."""
    package: Any = importlib.import_module("certreg")
    names = (name for name in package.__all__ if name not in {PUBLIC_MODULE, "__version__"})
    return {name: getattr(package, name).__module__ for name in names}


def _described(dotted: str) -> str:
    """The name under which the reference describes it: the public one if it has one."""
    for name, home in public_homes().items():
        full = f"{home}.{name}"
        if dotted == full or dotted.startswith(f"{full}."):
            return f"certreg.{name}{dotted.removeprefix(full)}"
    return dotted


def _source(found: Any) -> str | None:
    if isinstance(found, property):
        found = found.fget
    if not (inspect.isfunction(found) or inspect.isclass(found)):
        return None
    return textwrap.dedent(inspect.getsource(found))
