"""The report of a registration with wrong pairs: still pictures, and no script."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Self, cast

from certreg.errors import DegenerateProblemError
from certreg.registration.breaking import simulate_breaking
from certreg.registration.consensus_words import are_words
from certreg.report.any_report import AnyReport, head_of, pairs_words
from certreg.report.breaking import breaking_course
from certreg.report.consensus_fit import fit_theorems, fit_verdict, kinds_words, marked
from certreg.report.consensus_picture import pairs_picture, residual_chart
from certreg.report.consensus_reach import reach_degrees, why_unbounded
from certreg.report.lines import number
from certreg.report.overview import Overview
from certreg.report.pairs import HARDER, TOLD_SECOND, counted_labels, pair_remedies, warnings_of
from certreg.report.pose_facts import Fact
from certreg.report.remedies import causes, remedies
from certreg.report.scaled_consensus import scale_sentences
from certreg.report.sections import Section, rows_table
from certreg.report.sentences import Sentence, begun, sentence
from certreg.results import Guarantee

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from certreg.registration.consensus import ConsensusRegistration
    from certreg.report.viewer import Names


MOST_ROWS = 40  # undecided pairs in the table
MOST_MOVED = 200  # pairs of which the motion on springs that break is shown
WEAK_FIT = "This certificate proves far less of the least-squares pose than can be proved."
BREAKS = (
    "Each pair is a spring that breaks beyond its bound; the bounds begin wide and shrink to those "
    "given."
)
SCALED_RULES = ("scaled_lengths", "few_neighbours", "few_colours", "scaled_refutation")
RULES = ("pair_lengths", "few_neighbours", "few_colours", "weighted_refutation")
NOT_CLAIMED = (
    "that an inlier is a right pair: only that every motion that meets as many meets it, too",
    "how many pairs the other motion meets: a search found it, and none is proved to be best",
    "anything of the names in the certificate, and where the points come from",
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ConsensusReport(AnyReport[Any]):
    """What a page shows of a registration with wrong pairs."""

    registration: ConsensusRegistration

    @classmethod
    def of(cls, registration: Any, *, documentation: str | None = None) -> Self:
        """The report of a registration with wrong pairs just made."""
        result = cast("ConsensusRegistration", registration)
        return cls(
            registration=result,
            certificate=result.certificate,
            content=result.certificate.to_json(),
            verdict=result.verdict,
            documentation=documentation,
        )

    @property
    def digested(self) -> str:
        """What the digest binds: springs in the place of weights, where there are some."""
        springs = self.registration.problem.springs is not None
        return "points, bounds and springs" if springs else "points, weights and bounds"

    def values(self, names: Names) -> Mapping[str, Any]:
        """Headline, pose and pictures; residuals, what is undecided, the other motion; proofs."""
        result = self.registration
        picture = pairs_picture(result)
        head = head_of(
            result.headline,
            further=[*[WEAK_FIT] * self.weak, *causes(result.fit)],
            todo=[
                *[f"{HARDER}."] * ("undecided" in result.labels),
                *pair_remedies(result),
                *remedies(result.fit),
            ],
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


def _sections(result: ConsensusRegistration, names: Names) -> Iterator[Section]:
    """Residuals against bounds; what is undecided; another motion; springs that break."""
    yield Section(
        name="residuals",
        title="Residuals against the bounds",
        chart=residual_chart(result),
        words=list(_residual_words(result)),
    )
    rows = list(_undecided_rows(result))
    if rows:
        yield Section(
            name="undecided",
            title="What is undecided, and why",
            words=(_undecided_words(result),),
            table=rows_table(("residual", "over its bound"), rows, names),
        )
    if (other := _other_words(result)) is not None:
        yield Section(name="other", title="The other motion", words=(other,))
    if (course := _course(result)) is not None:
        yield Section(name="course", title="On springs that break", lead=BREAKS, course=course)


def _overview(result: ConsensusRegistration) -> Overview:
    """That of the least squares over the met pairs, with what is proved of all pairs first."""
    labels, found = result.labels, result.lower
    own = Overview.of(result.fit)
    reach = reach_degrees(result)
    facts = [
        Fact(name="Within bounds", value=f"{found} of {result.problem.n}", words="by one motion"),
        Fact(name="No motion", value=f"more than {result.upper}", words="within"),
        Fact(
            name="Labels",
            value=counted_labels(labels),
            words=f"in every motion that brings {found} within",
        ),
    ]
    if reach is None:
        facts.append(Fact(name="Angle", value="not bounded", words=why_unbounded(result)))
    else:
        words = f"from this rotation to that of any motion that brings these {found} within"
        facts.append(Fact(name="Angle", value=f"≤ {reach}°", words=words))
    return replace(marked(own, result.against), proved=(*facts, *own.proved))


def _residual_words(result: ConsensusRegistration) -> Iterator[str]:
    largest = number(float(result.residuals[result.inliers].max()))
    yield f"The pose is fitted by least squares to the {result.lower} pairs that are met."
    if (kinds := kinds_words(result)) is not None:
        yield f"{begun(kinds)}."
        if result.fit.unique is not True:
            yield f"Of the least squares: {fit_verdict(result.fit)[0]}"
    if result.broken:
        rows = result.names.counted(result.broken[:8], len(result.broken))
        yield (
            f"It leaves {rows}, beyond the bound, though one motion, the witness in the "
            "certificate, meets all of them."
        )
    yield f"The largest residual of a met pair is {largest}."


def _undecided_rows(result: ConsensusRegistration) -> Iterator[tuple[int, tuple[str, str]]]:
    residuals, bounds = result.residuals, result.problem.bounds
    rows = [row for row, word in enumerate(result.labels) if word == "undecided"]
    for row in sorted(rows, key=lambda row: float(residuals[row] / bounds[row]))[:MOST_ROWS]:
        share = float(residuals[row] / bounds[row])
        yield row, (number(float(residuals[row])), f"{share:.3g}")


def _undecided_words(result: ConsensusRegistration) -> str:
    count = result.labels.count("undecided")
    more = f" The {MOST_ROWS} nearest to their bounds are listed." if count > MOST_ROWS else ""
    them = "it" if count == 1 else "them"
    return (
        f"Of {pairs_words(count)} nothing is proved: no test showed that a motion that meets "
        f"{result.lower} pairs must leave {them} out, or must meet {them}. What is a little beyond "
        f"its bound may be met by another motion that is as good.{more}"
    )


def _other_words(result: ConsensusRegistration) -> str | None:
    if result.second is None or result.second < TOLD_SECOND:
        return None
    return (
        f"Another motion fits {result.second} of the other {result.problem.n - result.lower} pairs "
        "(found, not proved to be the most): a second body, or an agreement by chance."
    )


def _course(result: ConsensusRegistration) -> Any:
    """The motion while the springs break, of a rigid body; None of many pairs."""
    problem = result.problem
    other = problem.motion.options or problem.springs is not None
    if problem.n > MOST_MOVED or other or not problem.weights.all():
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


def _known(result: ConsensusRegistration) -> Iterator[Sentence]:
    labels, found = result.labels, result.lower
    exact, out, sure = Guarantee.EXACT, labels.count("outlier"), labels.count("inlier")
    free = result.problem.motion.scales
    one, rules = ("motion with a scale", SCALED_RULES) if free else ("rigid motion", RULES)
    yield Sentence(
        words=f"One {one} brings {found} of the {result.problem.n} pairs within their "
        "bounds: the witness, tested in integers.",
        guarantee=exact,
    )
    yield Sentence(
        words=f"No {one} brings more than {result.upper} within.",
        guarantee=exact,
        theorems=rules,
    )
    yield Sentence(
        words=f"Of the {result.problem.n} pairs {are_words(sure, 'inlier')} and "
        f"{are_words(out, 'outlier')} in every motion that brings {found} within.",
        guarantee=exact,
        theorems=rules,
    )
    for words in scale_sentences(result):
        yield Sentence(words=words, guarantee=exact, theorems=rules)
    if (reach := reach_degrees(result)) is not None:
        yield Sentence(
            words=f"The rotation of every motion that brings these {found} within is at most "
            f"{reach} degrees from that of the pose given below.",
            guarantee=exact,
            theorems=("angle_of_consensus",),
        )
    yield Sentence(
        words=f"The least squares over these {found} pairs: {result.fit.status.value}.",
        guarantee=exact,
        theorems=fit_theorems(result.fit),
    )
