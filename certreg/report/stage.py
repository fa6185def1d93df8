"""The part of the page where the bodies move: the scene, its controls, the poses at rest."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from certreg.report.captions import component_name, factor_words
from certreg.report.markup import Markup, element
from certreg.report.summary import number

if TYPE_CHECKING:
    from certreg.registration import Registration

SPRINGS_WORDS = (
    "Each pair is joined by a spring, and the source moves as one rigid body, with friction, until "
    "it rests. Where it can rest is known completely."
)
INDEX_WORDS = "The index counts the independent turns that lower the energy: 0 only at the best."


def stage(registration: Registration) -> Markup:
    """The scene, what moves it, and a button for each pose at rest."""
    equilibria = registration.equilibria
    rests = [_rest(registration, i) for i in range(len(equilibria.components))]
    film = element(
        "div",
        element("div", _view(), _bar(), class_="film"),
        element("p", id="caption", role="status"),
        element("button", "Push it", id="push", type="button", hidden=True),
        element("div", id="along"),
    )
    choices = element(
        "div",
        element(
            "div",
            element("h3", "Watch the registration"),
            _button("From the start", "the source as it was given, released", id="released"),
            id="watch",
        ),
        element("h3", "Every pose at which it can rest"),
        element("div", *rests, class_="rests", role="group", aria_label="Poses at rest"),
        element("p", INDEX_WORDS, class_="note"),
        class_="choices",
    )
    silent = element("noscript", element("p", "The pictures need JavaScript; the words do not."))
    return element(
        "div",
        element("p", SPRINGS_WORDS, class_="note"),
        silent,
        element("div", film, choices, class_="stage"),
    )


def _view() -> Markup:
    zooms = (("+", "Closer"), ("−", "Farther"), ("⟲", "As at first"))
    return element(
        "div",
        element(
            "canvas",
            id="view",
            tabindex=0,
            role="img",
            aria_label="The two clouds in space. Arrow keys turn, + and - zoom, Home resets, "
            "space plays.",
        ),
        element("div", id="tags", aria_hidden="true"),
        element("p", id="view-note", role="status"),
        element("p", id="legend", aria_hidden="true"),
        element(
            "div",
            *(
                element("button", sign, type="button", title=words, aria_label=words)
                for sign, words in zooms
            ),
            id="zoom",
        ),
        class_="view",
    )


def _bar() -> Markup:
    return element(
        "div",
        element("button", "Play", id="play", type="button"),
        element("label", "Time", for_="time", class_="unseen"),
        element("input", id="time", type="range", min=0, max=1000, value=0, step="any"),
        element("output", id="clock", for_="time"),
        class_="bar",
    )


def _rest(registration: Registration, index: int) -> Markup:
    equilibria = registration.equilibria
    component = equilibria.components[index]
    away = math.degrees(component.angle_to_optimum)
    fit = [f"RMSE {number(component.rmse)}"]
    if not component.optimal:
        fit += filter(None, [factor_words(equilibria, index), f"{away:.4g}° from the optimum"])
    return _button(
        component_name(equilibria, index),
        *fit,
        badge=f"index {component.morse_index}",
        class_="rest best" if component.optimal else "rest wrong",
        data_component=index,
    )


def _button(name: str, *notes: str, badge: str = "", **attributes: str | int) -> Markup:
    return element(
        "button",
        element("span", name, class_="name"),
        element("span", badge, class_="badge"),
        *(element("span", note, class_="note") for note in notes),
        type="button",
        aria_pressed="false",
        **attributes,
    )
