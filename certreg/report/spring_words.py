"""What the page of general springs says in sentences: what is proved, and what is not claimed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg.exact.decimals import at_least, at_most
from certreg.registration.headlines import proved_degrees
from certreg.registration.result import Method
from certreg.report.pose_words import gap_words
from certreg.report.spring_summary import few_words, how_words, relaxation_words, soft_words
from certreg.report.words import NOT_CLAIMED, Sentence, robustness_sentences, sentence
from certreg.results import Guarantee

if TYPE_CHECKING:
    from collections.abc import Iterator

    from certreg.registration.quartic import QuarticSolution
    from certreg.registration.result import Registration
    from certreg.report.spring_listed import Listed


RESTS_ON = {
    Method.SQUARES: ("quartic_relaxation", "growth_form"),
    Method.CONES: ("bernstein_cones", "spring_caps", "growth_form"),
    Method.ENERGY: (),
}
RIGHT_SPRINGS = (
    "that the springs are right: normals, directions and covariances are taken as they are "
    "given, and so are those that an iterative method froze at the rotation of its last step;"
)
ALONE = "whether one rotation alone is optimal: that is not decided;"
MANY = "general springs have up to forty equilibria, or infinitely many, stable ones among them"
NOWHERE = f"where else the springs balance: {MANY}, and this page lists none;"
NOT_ALL = f"that no equilibria are missing in the list above: {MANY};"
LIST_ALONE = "The list was made for this page, and the certificate below does not hold it"
LIST_CERTIFIED = "certreg equilibria --out writes one that does."


def spring_sentences(
    registration: Registration[QuarticSolution], listed: Listed | None
) -> list[Sentence]:
    """What the page says is known; the checker has accepted what the certificate claims."""
    return [
        *_optimality(registration),
        *_uniqueness(registration),
        *_growth(registration),
        *_list(listed),
        *robustness_sentences(registration, "growth_radius"),
        *_numbers(registration),
    ]


def not_claimed_of_springs(
    registration: Registration[QuarticSolution], listed: Listed | None
) -> tuple[str, ...]:
    """What the page does not say, with what is open of these springs."""
    *before, last = NOT_CLAIMED
    own = [RIGHT_SPRINGS]
    if registration.solution.unique_rotation is None:
        own.append(ALONE)
    if listed is None or not listed.rows:
        own.append(NOWHERE)
    elif not listed.complete:
        own.append(NOT_ALL)
    return (*before, *own, last)


def _optimality(registration: Registration[QuarticSolution]) -> Iterator[Sentence]:
    bounds, method = registration.bounds, registration.method
    if bounds is None or method is None:
        return
    motion = registration.problem.motion
    words = gap_words(motion, "the energy of the springs", bounds.greatest_gap)
    yield Sentence(
        words=f"{words} It is proved by {how_words(registration)}.",
        guarantee=Guarantee.EXACT,
        theorems=(*RESTS_ON[method], *["spring_translation"] * (motion.translations > 0)),
    )


def _uniqueness(registration: Registration[QuarticSolution]) -> Iterator[Sentence]:
    solution, degrees = registration.solution, proved_degrees(registration)
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
        if degrees is not None:
            words = f"Every optimal rotation is within {degrees} degrees of the one given below."
            yield Sentence(words=words, guarantee=exact, theorems=("growth_form",))
        if soft := soft_words(registration):
            yield Sentence(words=sentence(soft), guarantee=Guarantee.NUMERICAL)
        if few := few_words(registration):
            yield Sentence(words=sentence(few), guarantee=exact)


def _growth(registration: Registration[QuarticSolution]) -> Iterator[Sentence]:
    certificate = registration.certificate
    if certificate is None or not certificate.body.growth:
        return
    mu, delta = certificate.body.growth, certificate.body.gap
    shifted = ", with whatever translation" if registration.problem.motion.translations else ""
    yield Sentence(
        words=(
            "A rotation that is turned by an angle a from the certified one costs at least "
            f"{at_least(mu)} sin²(a/2) - {at_most(delta)} more{shifted}."
        ),
        guarantee=Guarantee.EXACT,
        theorems=("growth_form",),
    )


def _list(listed: Listed | None) -> Iterator[Sentence]:
    if listed is not None and listed.complete:
        forty = "forty_lines" in listed.theorems  # of others no certificate is made
        end = f": {LIST_CERTIFIED}" if forty else "."
        yield Sentence(
            words=f"{listed.words} {LIST_ALONE}{end}",
            guarantee=listed.guarantee,
            theorems=listed.theorems,
        )


def _numbers(registration: Registration[QuarticSolution]) -> Iterator[Sentence]:
    yield Sentence(
        words="The pose and its energy are rounded to doubles from far more digits.",
        guarantee=Guarantee.NUMERICAL,
    )
    words = f"The semidefinite relaxation: {relaxation_words(registration)}."
    yield Sentence(words=words, guarantee=Guarantee.NUMERICAL)
