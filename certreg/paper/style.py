"""One style for all figures: colours of Okabe and Ito, and never colour alone.

Everybody tells these colours apart, and where they are printed in grey, markers, line styles and
hatching do. Nothing of the user's own matplotlib settings enters, so that a figure is the same
everywhere.
"""

from __future__ import annotations

import io
from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from certreg._loading import library

BLUE, VERMILLION, GREEN, ORANGE, BLACK = "#0072B2", "#D55E00", "#009E73", "#E69F00", "#000000"
GREY, PALE = "#6E6E6E", "#EDEDED"
INDEX_MARKERS = ("o", "^", "s", "X")  # of equilibria, by Morse index
INDEX_COLOURS = (BLUE, VERMILLION, GREEN, BLACK)
WIDTH = 7.2  # inches: a page's
DPI = 200
SETTINGS: dict[str, Any] = {
    "axes.grid": False,
    "axes.linewidth": 0.7,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": 9.0,
    "axes.titlelocation": "left",
    "axes.unicode_minus": True,
    "figure.dpi": DPI,  # of the layout, too
    "figure.facecolor": "white",
    "font.family": "DejaVu Sans",  # comes with matplotlib
    "font.size": 8.5,
    "hatch.linewidth": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "lines.linewidth": 1.3,
    "mathtext.fontset": "dejavusans",
    "pdf.fonttype": 42,  # TrueType: editable, and accepted by publishers
    "savefig.dpi": "figure",
    "svg.fonttype": "path",
    "svg.hashsalt": "certreg",  # identifiers in the file do not change from run to run
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
}
NO_DATE: dict[str, dict[str, Any]] = {
    "pdf": {"CreationDate": None},
    "svg": {"Date": None},
    "png": {"Software": None},
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drawing:
    """A figure (matplotlib's) with its file name, its title, and what is to be seen in it."""

    name: str
    title: str
    caption: str
    figure: Any


@contextmanager
def house_style() -> Generator[None]:
    """The style, for what is drawn and written inside."""
    mpl = library("matplotlib", "a figure")
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(SETTINGS)
        yield


def blank(height: float) -> Any:
    """An empty figure (matplotlib.figure.Figure) of the page's width, `height` in inches."""
    figures = library("matplotlib.figure", "a figure")
    return figures.Figure(figsize=(WIDTH, height), layout="constrained")


def finished(name: str, title: str, caption: str, figure: Any) -> Drawing:
    """A figure laid out once and for all: to lay it out at each writing would move it a little."""
    with house_style():
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
    return Drawing(name=name, title=title, caption=caption, figure=figure)


def written(drawing: Drawing, kind: str) -> bytes:
    """The file of a drawing: "pdf", "svg" or "png". The same drawing gives the same bytes."""
    with house_style(), io.BytesIO() as stream:
        drawing.figure.savefig(stream, format=kind, metadata=NO_DATE[kind])
        return stream.getvalue()
