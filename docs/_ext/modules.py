"""One page for every module of `certreg` and `derivations`, and `{modules}`, the list of them.

The pages are written into reference/modules/ before the build reads its sources; they hold nothing
but an `automodule`. The claims are left out: their pages are the proofs.
"""

from __future__ import annotations

import importlib
import pkgutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

from docutils import nodes
from listings import public_homes, reference_to
from proofs import MarkdownDirective, table

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sphinx.application import Sphinx
    from sphinx.util.typing import ExtensionMetadata

PACKAGES = ("certreg", "derivations")
LEFT_OUT = ("certreg.__main__", "derivations.claims")
FOLDER = "modules"
PAGE = """\
---
orphan: true
---
# {name}

[All modules](../modules.md)

```{{eval-rst}}
.. automodule:: {name}
   :members:
   :exclude-members: {public}
```
"""


def module_names() -> list[str]:
    """The dotted names of all modules that have a page."""
    return sorted(name for package in PACKAGES for name in _within(package))


def page_of(name: str) -> str:
    """The page of a module; what is public is described on the page of the public names."""
    public = [own for own, home in public_homes().items() if home == name]
    text = PAGE.format(name=name, public=", ".join(public) or "none")
    links = ", ".join(f"{{py:obj}}`certreg.{own}`" for own in public)
    return f"{text}\nPublic, and described [there](../python.md): {links}.\n" if public else text


def _within(package: str) -> Iterator[str]:
    places = importlib.import_module(package).__path__
    for found in pkgutil.walk_packages(places, prefix=f"{package}."):
        if not found.name.startswith(LEFT_OUT):
            yield found.name


class Modules(MarkdownDirective):
    """The modules of a package, each with the first sentence of its docstring."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """A table. In the navigation, drawn anew for every page, so many would cost a minute."""
        names = [n for n in module_names() if n.startswith(f"{self.arguments[0]}.")]
        header = [nodes.paragraph(text=word) for word in ("module", "what it holds")]
        rows = [[self._link(name), nodes.paragraph(text=_first_line(name))] for name in names]
        return [table(header, rows, (42, 58), "modules")]

    def _link(self, name: str) -> nodes.paragraph:
        return nodes.paragraph("", "", reference_to(name, self.env.docname))


def _first_line(name: str) -> str:
    return (importlib.import_module(name).__doc__ or "").partition("\n")[0].replace("`", "")


def _write_pages(app: Sphinx) -> None:
    """The pages as they must be; untouched where they are so already."""
    folder = Path(app.srcdir, "reference", FOLDER)
    folder.mkdir(parents=True, exist_ok=True)
    wanted = {f"{name}.md": page_of(name) for name in module_names()}
    for page in folder.glob("*.md"):
        if page.name not in wanted:
            page.unlink()
    for name, text in wanted.items():
        page = folder / name
        if not page.exists() or page.read_text("utf-8") != text:
            page.write_text(text, "utf-8")


def forget_others(app: Sphinx, page: nodes.document) -> None:
    """Nodes remember no document but the page's own, which is what Sphinx keeps in a file.

    What autodoc makes remembers another, and with it the environment: all that is known of all
    pages would be written for each, some megabytes, and read again.
    """
    del app
    for node in page.findall():
        if node.document is not page:
            node.document = page


class Navigation:
    """The navigation of pages that are not in it themselves: the same on all of a folder.

    Sphinx draws it anew for every page; of hundreds of pages of code that is a sixth of the build.
    """

    def __init__(self) -> None:
        self._drawn: dict[tuple[str, str], str] = {}

    def kept(
        self, app: Sphinx, pagename: str, _template: str, context: dict[str, Any], _tree: Any
    ) -> None:
        """Draw the navigation once for each folder of such pages."""
        draw = context.get("toctree")
        in_it = any(pagename in pages for pages in app.env.toctree_includes.values())
        if draw is None or in_it or pagename == app.config.root_doc:
            return

        def drawn(**options: Any) -> str:
            key = (pagename.rpartition("/")[0], repr(sorted(options.items())))
            if key not in self._drawn:
                self._drawn[key] = draw(**options)
            return self._drawn[key]

        context["toctree"] = drawn


def setup(app: Sphinx) -> ExtensionMetadata:
    """Called by Sphinx."""
    app.add_directive("modules", Modules)
    app.connect("builder-inited", _write_pages)
    app.connect("doctree-read", forget_others)
    app.connect("html-page-context", Navigation().kept, priority=400)  # before the theme asks
    return {"parallel_read_safe": True, "parallel_write_safe": True}
