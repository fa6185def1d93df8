"""How the documentation is built: `make docs`. Nothing of it needs a network, then or later."""

from __future__ import annotations

import functools
import inspect
import os
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "_ext"), str(HERE.parent)]
# For the kernels that run the code cells, and for the plots in them.
os.environ["PYTHONPATH"] = str(HERE.parent)
os.environ["MATPLOTLIBRC"] = str(HERE / "matplotlibrc")
os.environ["PYDEVD_DISABLE_FILE_VALIDATION"] = "1"  # kernels say nothing of debuggers
os.environ["SOURCE_DATE_EPOCH"] = os.environ.get("SOURCE_DATE_EPOCH", "0")

# They take no settings of this machine's user, and say nothing of their sockets.
kernels = tempfile.TemporaryDirectory(prefix="certreg-docs-")
Path(kernels.name, "profile_default").mkdir()
Path(kernels.name, "profile_default", "ipython_kernel_config.py").write_text(
    "c = get_config()\nc.IPKernelApp.log_level = 40\nc.HistoryManager.enabled = False\n", "utf-8"
)
os.environ["IPYTHONDIR"] = kernels.name

from certreg import __version__  # noqa: E402  (found through the path above)

project = "certreg"
author = "The certreg developers"
copyright = author  # noqa: A001  (Sphinx calls it so)
version = release = __version__
language = "en"

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx.ext.viewcode",
    "citations",
    "command_lines",
    "contents",
    "disclosure",
    "docstrings",
    "interface",
    "leftovers",
    "modules",
    "proofs",
    "reports",
]
exclude_patterns = ["_build", "_ext", "_static"]

# A draft may speak of claims that the book does not have yet.
draft = bool(os.environ.get("CERTREG_DOCS_DRAFT"))
nitpicky = True
# Annotations name types that only a type checker imports: they have no place to lead to.
nitpick_ignore_regex = [(r"py:(class|data|exc)", r".*")]

myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
myst_links_external_new_tab = False
nb_execution_mode = "force"
nb_execution_raise_on_error = False  # a warning with the traceback, and so an error of the build
nb_execution_show_tb = True
nb_execution_in_temp = True
nb_execution_timeout = 300  # a cell that never ends; a busy machine takes a minute for a second's
nb_merge_streams = True
nb_render_markdown_format = "myst"  # tables that a cell makes are tables
nb_ipywidgets_js = {}

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
# For that the source of each function is looked up twice, and for each class its file is parsed.
inspect.getsource = functools.cache(inspect.getsource)
autodoc_use_type_comments = False  # there are none, and to look for them takes seconds
add_module_names = False
python_use_unqualified_type_names = True
toc_object_entries_show_parents = "hide"

# MathJax 3.2, whole: no menu, which could load more; an unknown macro is an error, not red letters.
mathjax_path = "vendor/tex-svg-full.js"
mathjax3_config = {
    "tex": {"packages": {"[-]": ["autoload", "noerrors", "noundefined", "require"]}},
    "options": {"enableMenu": False},
    "svg": {"fontCache": "local"},
}

html_theme = "furo"
html_title = "certreg"
html_static_path = ["_static"]
html_css_files = ["certreg.css"]
html_js_files = ["wide-formulas.js"]
templates_path = ["_templates"]
html_copy_source = False
html_show_search_summary = False  # it would be fetched, which pages opened from a folder may not
html_show_sphinx = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#00507a", "color-brand-content": "#00629b"},
    "dark_css_variables": {"color-brand-primary": "#6cb6e8", "color-brand-content": "#7cc0ee"},
}
pygments_style = "friendly"
pygments_dark_style = "native"
