"""The report of a registration by truncated squares: still pictures, and no script."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.exact.decimals import at_least, at_most
from certreg.registration.pair_angles import widest_angles
from certreg.registration.pair_words import are_words
from certreg.report.any_report import AnyReport, head_of, pairs_words
from certreg.report.consensus_fit import marked
from certreg.report.consensus_picture import pairs_picture, residual_chart
from certreg.report.lines import number
from certreg.report.overview import Overview
from certreg.report.pairs import (
    counted_labels,
    optimum_degrees,
    truncated_causes,
    truncated_remedies,
    warnings_of,
    why_unbounded,
)
from certreg.report.pose_facts import Fact
from certreg.report.sections import Section, rows_table
from certreg.report.sentences import Sentence, begun, sentence
from certreg.results import Guarantee

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from numpy.typing import NDArray

    from certreg.registration.labelled import TruncatedRegistration
    from certreg.report.viewer import Names
    from certreg.verify import Worth


MOST_ROWS = 40  # undecided pairs in the table
NEAREST = 12  # pairs nearest to their bounds, in the table
COST_DIGITS = 9  # of a cost, rounded outwards
HEAD = ("angle", "largest allowed", "residual", "over its bound", "at every optimum")
BOXES = ("truncated_survey", "truncated_box", "chord_bound")
NOT_CLAIMED = (
    "that an inlier is a right pair: only that every optimum has it within its bound",
    "that the rotation is close to the truth: only that its truncated cost is near the least",
    "anything of the names in the certificate, and where the points come from",
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TruncatedReport(AnyReport[Any]):
    """What a page shows of a registration by truncated squares."""

    registration: TruncatedRegistration

    @property
    def digested(self) -> str:
        """What the digest binds, in words."""
        return "points, weights and bounds"

    def values(self, names: Names) -> Mapping[str, Any]:
        """Headline, rotation and pictures; angles against the bounds, what is undecided; proofs."""
        result = self.registration
        picture = pairs_picture(result)
        head = head_of(
            result.headline,
            further=truncated_causes(result),
            todo=truncated_remedies(result),
            warnings=warnings_of(result),
        )
        return {
            **head,
            "good": result.good,
            "overview": _overview(result),
            "picture": picture,
            "picture_words": "" if picture is None else sentence(begun(picture.words)),
            "pairs_shown": True,
            "sections": list(_sections(result, names)),
            "known": list(_known(result)),
            "not_claimed": [sentence(begun(words)) for words in NOT_CLAIMED],
            "certificate_link": self.certificate_link,
        }


def _sections(result: TruncatedRegistration, names: Names) -> Iterator[Section]:
    """Angles against the bounds, the nearest first; and what is undecided."""
    share, labels = result.residuals / result.problem.bounds, np.array(result.labels)
    near = np.argsort(np.abs(np.log(np.maximum(share, np.finfo(float).tiny))), kind="stable")
    undecided = near[labels[near] == "undecided"]
    yield Section(
        name="residuals",
        title="Angles and residuals against the bounds",
        chart=residual_chart(result),
        words=[*_residual_words(result), *_nearest_words(result.problem.n)],
        table=rows_table(HEAD, list(_rows(result, near[:NEAREST])), names),
    )
    if len(undecided):
        yield Section(
            name="undecided",
            title="What is undecided, and why",
            words=(_undecided_words(len(undecided)),),
            table=rows_table(HEAD, list(_rows(result, undecided[:MOST_ROWS])), names),
        )


def _worth(result: TruncatedRegistration) -> Worth:
    worth = result.verdict.worth
    assert worth is not None  # noqa: S101 - there is a page of an accepted certificate alone
    return worth


def _overview(result: TruncatedRegistration) -> Overview:
    """That of the least squares over the pairs within, with what is proved of all rotations."""
    worth = _worth(result)
    gap, degrees = at_most(worth.gap, 2), optimum_degrees(result)
    turn = Fact(name="Angle", value="not bounded", words=why_unbounded(result))
    if degrees is not None:
        turn = Fact(name="Angle", value=f"≤ {degrees}°", words="from this rotation to any optimum")
    facts = (
        Fact(
            name="Truncated cost",
            value=f"≤ {at_most(worth.objective, COST_DIGITS)}",
            words="of the certified rotation",
        ),
        Fact(
            name="Least cost",
            value=f"≥ {at_least(worth.minimum, COST_DIGITS)}",
            words=f"over all rotations; the certified one has less than {gap} more",
        ),
        Fact(name="Labels", value=counted_labels(result.labels), words="at every optimum"),
        turn,
    )
    return replace(marked(Overview.of(result.fit), result.against), proved=facts)


def _residual_words(result: TruncatedRegistration) -> Iterator[str]:
    """Which pairs the rotation is fitted to, and which angles their bounds allow."""
    problem, within = result.problem, len(result.inliers)
    yield (
        f"The rotation is fitted by least squares to the {pairs_words(within)} within, each "
        "residual divided by its bound."
    )
    most = np.degrees(widest_angles(problem.source, problem.target, problem.bounds))
    allowed = most[np.isfinite(most)]
    if len(allowed):
        low, high = (_widest(float(end)) for end in (allowed.min(), allowed.max()))
        angles = low if low == high else f"{low} to {high}, depending on the pair"
        yield f"A pair is within its bound where the angle between its points is at most {angles}."
    if (far := int(np.isnan(most).sum())) > 0:
        beyond = "pair is beyond its bound" if far == 1 else "pairs are beyond their bounds"
        yield (
            f"{far} {beyond} at every rotation: the distances of the two points from the origin "
            "differ by more than the bound."
        )


def _rows(
    result: TruncatedRegistration, rows: NDArray[np.intp]
) -> Iterator[tuple[int, tuple[str, ...]]]:
    """These pairs for a table, under HEAD."""
    problem, residuals = result.problem, result.residuals
    angles = np.degrees(result.angles)
    most = np.degrees(widest_angles(problem.source, problem.target, problem.bounds))
    for row in rows.tolist():
        yield (
            row,
            (
                _degrees(float(angles[row])),
                _widest(float(most[row])),
                number(float(residuals[row])),
                f"{float(residuals[row] / problem.bounds[row]):.3g}",
                result.labels[row],
            ),
        )


def _nearest_words(n: int) -> list[str]:
    """That not all are listed, and where they are."""
    if n <= NEAREST:
        return []
    words = (
        f"Of the {n} pairs the {NEAREST} nearest to their bounds are listed; the residuals "
        "and labels of all are in fit.csv, which certify --out writes, the labels in the JSON, too "
        "(truncated.labels)."
    )
    return [words]


def _degrees(angle: float) -> str:
    return "none" if np.isnan(angle) else f"{angle:.3g}°"


def _widest(angle: float) -> str:
    """An angle up to which a pair is within its bound."""
    return "none" if np.isnan(angle) else f"{at_least(angle)}°"


def _undecided_words(count: int) -> str:
    more = f" The {MOST_ROWS} nearest to their bounds are listed." if count > MOST_ROWS else ""
    return (
        f"For {pairs_words(count)} it is not proved on which side of the bound the residual is at "
        "the optima: two optima differ there, or at one of them it is so near to the bound that "
        f"the search does not tell.{more}"
    )


def _known(result: TruncatedRegistration) -> list[Sentence]:
    exact, worth, labels = Guarantee.EXACT, _worth(result), result.labels
    cost, least = at_most(worth.objective, COST_DIGITS), at_least(worth.minimum, COST_DIGITS)
    sure, out = labels.count("inlier"), labels.count("outlier")
    counts = f"{are_words(sure, 'inlier')} and {are_words(out, 'outlier')}"
    told = [
        f"The certified rotation costs at most {cost}; no rotation costs less than {least}.",
        f"Of the {result.problem.n} pairs {counts} at every optimum.",
    ]
    if (degrees := optimum_degrees(result)) is not None:
        told.append(f"Every optimum is within {degrees} degrees of this rotation.")
    if result.unique:
        told.append("The optimum is one single rotation: every other one has a larger cost.")
    found = [Sentence(words=words, guarantee=exact, theorems=BOXES) for words in told]
    words = f"The least squares over the {pairs_words(len(result.inliers))} within: "
    fit = Sentence(
        words=f"{words}{result.fit.status.value}.",
        guarantee=exact,
        theorems=("optimality_certificate",),
    )
    return [*found, fit]
