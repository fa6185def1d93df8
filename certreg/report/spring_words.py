"""What the page of general springs says in sentences: what is proved, and what is not claimed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.registration import Method, at_least, at_most, spring_degrees
from certreg.report.spring_summary import NEVER_NEGATIVE, how_words, relaxation_words, soft_words
from certreg.report.words import NOT_CLAIMED, Sentence, robustness_sentences, sentence
from certreg.results import Guarantee

if TYPE_CHECKING:
    from collections.abc import Iterator

    from certreg.registration import SpringRegistration

RESTS_ON = {
    Method.SQUARES: ("quartic_relaxation",),
    Method.CONES: ("bernstein_cones", "spring_caps"),
}
NOT_CLAIMED_OF_SPRINGS = (
    *NOT_CLAIMED,
    (
        "that the springs are right: normals, directions and covariances are taken as they are "
        "given, and so are those that an iterative method froze at the rotation of its last step;"
    ),
    (
        "where else the springs balance: general springs have up to forty equilibria, or "
        "infinitely many, stable ones among them, and this page lists none."
    ),
)


def spring_sentences(registration: SpringRegistration) -> list[Sentence]:
    """What the page says is known; the checker has accepted what the certificate claims."""
    return [
        *_optimality(registration),
        *_uniqueness(registration),
        *_growth(registration),
        *robustness_sentences(registration, "growth_radius"),
        *_numbers(registration),
    ]


def _optimality(registration: SpringRegistration) -> Iterator[Sentence]:
    bounds, method = registration.bounds, registration.solution.method
    if bounds is None or method is None:
        return
    how = how_words(registration)
    theorems = () if how == NEVER_NEGATIVE else (*RESTS_ON[method], "growth_form")
    yield Sentence(
        words=(
            "Over all rotations and translations: the energy of the springs at the pose given "
            "below with all digits, by its quaternion and its translation, exceeds the minimum by "
            f"at most {at_most(bounds.greatest_gap)}. It is proved by {how}."
        ),
        guarantee=Guarantee.EXACT,
        theorems=(*theorems, "spring_translation"),
    )


def _uniqueness(registration: SpringRegistration) -> Iterator[Sentence]:
    solution, degrees = registration.solution, spring_degrees(registration)
    exact, free = Guarantee.EXACT, solution.freedom
    if words := free.turn_words():
        yield Sentence(words=sentence(words), guarantee=exact)
    if words := free.shift_words():
        theorems = ("spring_translation",)
        yield Sentence(words=sentence(words), guarantee=exact, theorems=theorems)
    if solution.unique_rotation:
        far = "" if degrees is None else f" It is within {degrees} degrees of the one given below."
        words = f"One rotation alone is optimal.{far}"
        yield Sentence(words=words, guarantee=exact, theorems=("growth_form",))
    elif solution.unique_rotation is False and not free.turn_words():
        words = "Two rotations at least are optimal, exactly as good as one another."
        yield Sentence(words=words, guarantee=exact)
    elif solution.unique_rotation is None:
        words, theorems = "Whether one rotation alone is optimal is not decided.", ()
        if degrees is not None:
            words += f" All that are lie within {degrees} degrees of the one given below."
            theorems = ("growth_form",)
        yield Sentence(words=words, guarantee=exact, theorems=theorems)
        if soft := soft_words(registration):
            yield Sentence(words=sentence(soft), guarantee=Guarantee.NUMERICAL)


def _growth(registration: SpringRegistration) -> Iterator[Sentence]:
    certificate = registration.certificate
    if certificate is None or not certificate.body.growth:
        return
    mu, delta = certificate.body.growth, certificate.body.gap
    yield Sentence(
        words=(
            "A rotation that is turned by an angle a from the certified one costs at least "
            f"{at_least(mu)} sin²(a/2) - {at_most(delta)} more, "
            "with whatever translation."
        ),
        guarantee=Guarantee.EXACT,
        theorems=("growth_form",),
    )


def _numbers(registration: SpringRegistration) -> Iterator[Sentence]:
    yield Sentence(
        words="The pose and its energy are rounded to doubles from far more digits.",
        guarantee=Guarantee.NUMERICAL,
    )
    words = f"The semidefinite relaxation: {relaxation_words(registration)}."
    yield Sentence(words=words, guarantee=Guarantee.NUMERICAL)
