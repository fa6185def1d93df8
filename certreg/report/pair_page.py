"""The report of pairs that may be wrong: still pictures, and no script."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import DegenerateProblemError
from certreg.exact.decimals import at_least, at_most
from certreg.problem.support import Loss, supported
from certreg.registration.breaking import simulate_breaking
from certreg.registration.pair_angles import widest_angles
from certreg.registration.pair_words import are_words, motion_words
from certreg.report.any_report import AnyReport, head_of, pairs_words
from certreg.report.breaking import breaking_course
from certreg.report.lines import number
from certreg.report.overview import Mark, Overview
from certreg.report.pair_picture import pairs_picture, residual_chart
from certreg.report.pairs import (
    TOLD_SECOND,
    counted_labels,
    fit_verdict,
    kinds_words,
    limit_words,
    pair_remedies,
    scale_sentences,
    sought,
    turn_words,
    turned_degrees,
    warnings_of,
)
from certreg.report.pose_facts import Fact
from certreg.report.remedies import causes, remedies
from certreg.report.sections import Section, Table, rows_table
from certreg.report.sentences import Sentence, begun, sentence
from certreg.report.words import RESTS_ON
from certreg.results import Absent, Guarantee, present

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from certreg.registration.labelled import (
        ConsensusRegistration,
        LabelledRegistration,
        TruncatedRegistration,
    )
    from certreg.registration.result import Registration
    from certreg.report.viewer import Names


MOST_ROWS = 40  # undecided pairs in the table
NEAREST = 12  # pairs nearest to their bounds, in the table
MOST_MOVED = 200  # pairs of which the motion on springs that break is shown
COST_DIGITS = 9  # of a cost, rounded outwards
HEAD = ("residual", "over its bound")
WEAK_FIT = "This certificate proves far less of the least-squares pose than can be proved."
BREAKS = (
    "Each pair is a spring that breaks beyond its bound; the bounds begin wide and shrink to those "
    "given."
)
SCALED_RULES = ("scaled_lengths", "few_neighbours", "few_colours", "scaled_refutation")
RULES = ("pair_lengths", "few_neighbours", "few_colours", "weighted_refutation")
BOXES = ("truncated_survey", "truncated_box", "chord_bound")
UNNAMED = "anything of the names in the certificate, and where the points come from"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PairsReport(AnyReport[Any]):
    """What a page shows of a registration of pairs that may be wrong."""

    registration: LabelledRegistration

    @property
    def digested(self) -> str:
        """What the digest binds: springs in the place of weights, where there are some."""
        springs = self.registration.problem.springs is not None
        return "points, bounds and springs" if springs else "points, weights and bounds"

    def values(self, names: Names) -> Mapping[str, Any]:
        """Headline, pose and pictures; residuals, what is undecided, the other motion; proofs."""
        result = self.registration
        picture, told = pairs_picture(result), sought(result)
        return {
            **head_of(
                result.headline,
                further=[*[WEAK_FIT] * self.weak, *limit_words(result), *causes(result.fit)],
                todo=[*pair_remedies(result), *remedies(result.fit)],
                warnings=warnings_of(result),
            ),
            "good": result.good,
            "overview": _overview(result),
            "picture": picture,
            "picture_words": "" if picture is None else sentence(begun(picture.words)),
            "pairs_shown": True,
            "sections": list(_sections(result, names)),
            "known": list(_known(result)),
            "not_claimed": [sentence(begun(words)) for words in (told.right, told.best, UNNAMED)],
            "certificate_link": self.certificate_link,
        }


def _everywhere(result: LabelledRegistration) -> str:
    """Where the labels hold."""
    return sought(result).everywhere.format(n=len(result.inliers))


def _overview(result: LabelledRegistration) -> Overview:
    """That of the least squares over the pairs within, with what is proved of all pairs first.

    Its fit is marked with what the first line says against pairs and pose, if anything; a mark that
    is open already says what it is of itself.
    """
    own, degrees = Overview.of(result.fit), turned_degrees(result)
    if result.against is not None and own.mark.kind != "open":
        own = replace(own, mark=Mark(kind="open", words=result.against.lower()))
    turn = f"from this rotation to {turn_words(result)}"
    if isinstance(degrees, Absent):
        angle = Fact(name="Angle", value="not bounded", words=degrees.reason)
    else:
        angle = Fact(name="Angle", value=f"≤ {degrees}°", words=turn)
    labels = Fact(name="Labels", value=counted_labels(result.labels), words=_everywhere(result))
    held = own.proved if isinstance(result.least, Absent) else ()  # a cost proves none of its fit
    return replace(own, proved=(*_sought_facts(result), labels, angle, *held))


def _sought_facts(result: LabelledRegistration) -> Iterator[Fact]:
    """How many pairs are within, or what the least cost is."""
    if (most := present(result.most)) is not None:
        within = f"{most.lower} of {most.problem.n}"
        yield Fact(name="Within bounds", value=within, words="by one motion")
        yield Fact(name="No motion", value=f"more than {most.upper}", words="within")
    if (least := present(result.least)) is not None:
        cost, minimum, gap = _costs(least)
        yield Fact(name="Truncated cost", value=f"≤ {cost}", words="of the certified rotation")
        more = f"over all rotations; the certified one has less than {gap} more"
        yield Fact(name="Least cost", value=f"≥ {minimum}", words=more)


def _costs(result: TruncatedRegistration) -> tuple[str, str, str]:
    """Of the certified rotation, of the least, and by what they differ: proved bounds."""
    worth = result.verdict.worth
    cost = at_most(worth.objective, COST_DIGITS)
    return cost, at_least(worth.minimum, COST_DIGITS), at_most(worth.gap, 2)


def _sections(result: LabelledRegistration, names: Names) -> Iterator[Section]:
    """Residuals against bounds; what is undecided; another motion; springs that break."""
    most, least = present(result.most), present(result.least)
    share = result.residuals / result.problem.bounds
    near = np.argsort(np.abs(np.log(np.maximum(share, np.finfo(float).tiny))), kind="stable")
    yield Section(
        name="residuals",
        title=f"{'Residuals' if least is None else 'Angles and residuals'} against the bounds",
        chart=residual_chart(result),
        words=list(_residual_words(result)),
        table=None if least is None else _table(result, near[:NEAREST], names),
    )
    undecided = near[np.array(result.labels)[near] == "undecided"]
    if len(undecided):
        yield Section(
            name="undecided",
            title="What is undecided, and why",
            words=(_undecided_words(result, len(undecided)),),
            table=_table(result, undecided[:MOST_ROWS], names),
        )
    if most is not None and (most.second or 0) >= TOLD_SECOND:
        other = (
            f"Another motion fits {most.second} of the other {most.problem.n - most.lower} pairs "
            "(found, not proved to be the most): a second body, or an agreement by chance."
        )
        yield Section(name="other", title="The other motion", words=(other,))
    if (course := _course(result)) is not None:
        yield Section(name="course", title="On springs that break", lead=BREAKS, course=course)


def _residual_words(result: LabelledRegistration) -> Iterator[str]:
    """What the pose is fitted to, and how far pairs are off."""
    most, least = present(result.most), present(result.least)
    within = pairs_words(len(result.inliers))
    if least is not None:
        yield (
            f"The rotation is fitted by least squares to the {within} within, each residual "
            "divided by its bound."
        )
        yield from _angle_words(least)
    if most is not None:
        yield f"The pose is fitted by least squares to the {within} that are met."
        yield from _met_words(most)


def _met_words(result: ConsensusRegistration) -> Iterator[str]:
    """By which springs, which pairs the pose leaves beyond their bounds, and how far one is off."""
    if (kinds := kinds_words(result.fit)) is not None:
        yield f"{begun(kinds)}."
        if result.fit.unique is not True:
            yield f"Of the least squares: {fit_verdict(result.fit)[0]}"
    if result.broken:
        rows = result.names.counted(result.broken[:8], len(result.broken))
        yield (
            f"It leaves {rows}, beyond the bound, though one motion, the witness in the "
            "certificate, meets all of them."
        )
    largest = number(float(result.residuals[result.inliers].max()))
    yield f"The largest residual of a met pair is {largest}."


def _angle_words(result: TruncatedRegistration) -> Iterator[str]:
    """Which angles the bounds allow, and that not all pairs are listed."""
    n, most = result.problem.n, _widest(result)
    allowed = most[np.isfinite(most)]
    if len(allowed):
        low, high = (_most_degrees(float(end)) for end in (allowed.min(), allowed.max()))
        angles = low if low == high else f"{low} to {high}, depending on the pair"
        yield f"A pair is within its bound where the angle between its points is at most {angles}."
    if (far := int(np.isnan(most).sum())) > 0:
        beyond = "pair is beyond its bound" if far == 1 else "pairs are beyond their bounds"
        yield (
            f"{far} {beyond} at every rotation: the distances of the two points from the origin "
            "differ by more than the bound."
        )
    if n > NEAREST:
        yield (
            f"Of the {n} pairs the {NEAREST} nearest to their bounds are listed; the residuals and "
            "labels of all are in fit.csv, which certify --out writes, the labels in the JSON, too "
            "(truncated.labels)."
        )


def _widest(result: TruncatedRegistration) -> NDArray[np.float64]:
    """(N,), degrees: up to which angle each pair is within its bound."""
    problem = result.problem
    return np.degrees(widest_angles(problem.source, problem.target, problem.bounds))


def _most_degrees(angle: float) -> str:
    return "none" if np.isnan(angle) else f"{at_least(angle)}°"


def _table(result: LabelledRegistration, rows: NDArray[np.intp], names: Names) -> Table:
    """How far some pairs are off beside their bounds; of rotations as angles, too."""
    off, share = result.residuals, result.residuals / result.problem.bounds
    shown: list[int] = rows.tolist()
    cells = [(number(float(off[row])), f"{share[row]:.3g}") for row in shown]
    if isinstance(result.least, Absent):
        return rows_table(HEAD, list(zip(shown, cells, strict=True)), names)
    angles, most = np.degrees(result.least.angles), _widest(result.least)
    turned = [
        ("none" if np.isnan(angles[row]) else f"{angles[row]:.3g}°", _most_degrees(most[row]))
        for row in shown
    ]
    told = [(*turned[k], *cells[k], result.labels[row]) for k, row in enumerate(shown)]
    head = ("angle", "largest allowed", *HEAD, "at every optimum")
    return rows_table(head, list(zip(shown, told, strict=True)), names)


def _undecided_words(result: LabelledRegistration, count: int) -> str:
    more = f" The {MOST_ROWS} nearest to their bounds are listed." if count > MOST_ROWS else ""
    if present(result.most) is None:
        return (
            f"For {pairs_words(count)} it is not proved on which side of the bound the residual is "
            "at the optima: two optima differ there, or at one of them it is so near to the bound "
            f"that the search does not tell.{more}"
        )
    them = "it" if count == 1 else "them"
    return (
        f"Of {pairs_words(count)} nothing is proved: no test showed that a motion that meets "
        f"{len(result.inliers)} pairs must leave {them} out, or must meet {them}. What is a little "
        f"beyond its bound may be met by another motion that is as good.{more}"
    )


def _course(result: LabelledRegistration) -> Any:
    """The motion while the springs break, where there is one; None of many pairs."""
    problem = result.problem
    breaking = supported(problem.cell._replace(loss=Loss.BREAKING))
    if problem.n > MOST_MOVED or not breaking or not problem.weights.all():
        return None
    block = problem.block(slice(None))
    try:
        run = simulate_breaking(
            block.source,
            block.target,
            max_residual=problem.bounds,
            weights=block.weights,
        )
    except DegenerateProblemError:  # a source on a line, or nearly so
        return None
    return breaking_course(run)


def _known(result: LabelledRegistration) -> Iterator[Sentence]:
    """What is proved of the pairs, or of the cost; of labels, scale, angle and least squares."""
    exact, labels, most = Guarantee.EXACT, result.labels, present(result.most)
    rules = BOXES if most is None else RULES if most.scale_interval is None else SCALED_RULES
    if most is not None:
        words = f"One {motion_words(most.problem).one} brings {most.lower} of the {most.problem.n} "
        words += "pairs within their bounds: the witness, tested in integers."
        yield Sentence(words=words, guarantee=exact)
    told = list(_sought_words(result))
    counts = f"{are_words(labels.count('inlier'), 'inlier')} and "
    counts += are_words(labels.count("outlier"), "outlier")
    told.append(f"Of the {result.problem.n} pairs {counts} {_everywhere(result)}.")
    for words in (*told, *scale_sentences(result)):
        yield Sentence(words=words, guarantee=exact, theorems=rules)
    degrees = turned_degrees(result)
    if not isinstance(degrees, Absent):
        words = f"It is at most {degrees} degrees from the rotation of the pose given below to "
        angle = BOXES if most is None else ("angle_of_consensus",)
        yield Sentence(words=f"{words}{turn_words(result)}.", guarantee=exact, theorems=angle)
    yield Sentence(
        words=f"The least squares over these {pairs_words(len(result.inliers))}: "
        f"{result.fit.status.value}.",
        guarantee=exact,
        theorems=_fit_theorems(result.fit),
    )


def _sought_words(result: LabelledRegistration) -> Iterator[str]:
    """What no other motion does better."""
    if (most := present(result.most)) is not None:
        yield f"No {motion_words(most.problem).one} brings more than {most.upper} within."
    if (least := present(result.least)) is not None:
        cost, minimum, _ = _costs(least)
        yield f"The certified rotation costs at most {cost}; no rotation costs less than {minimum}."
        if least.unique:
            yield "The optimum is one single rotation: every other one has a larger cost."


def _fit_theorems(fit: Registration) -> tuple[str, ...]:
    """What its optimality rests on."""
    method = fit.method
    if fit.equilibria is not None:
        return ("optimality_certificate",)
    return () if method is None else (*RESTS_ON[method], "spring_translation")
