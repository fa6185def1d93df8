"""A campaign over the user's own pairs: each is certified as `certreg certify` does it.

A pair that cannot be registered gives an object with its error, and the others go on. Its shard
is computed again when the campaign is: by then the file may be mended. So is the shard of a pair
whose files have changed: each line holds the digests of the files that it was computed from.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections import Counter, defaultdict
from collections.abc import Container, Iterator
from dataclasses import asdict, dataclass, field, replace
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from certreg import __version__
from certreg.campaign.listing import (
    NEEDED,
    SPRING_FILES,
    Listing,
    PairRow,
    asked_of_bounds,
    bounds_file,
    fault_of_bounds,
)
from certreg.campaign.runner import Campaign, contents
from certreg.campaign.store import Manifest, current_versions, digest_of
from certreg.campaign.table import COLUMNS, PARQUET, SUMMARY, Block, Column, write_table
from certreg.campaign.workers import Task, TaskResult
from certreg.errors import CertregError
from certreg.io.atomic import written_atomically
from certreg.io.labels import Match
from certreg.io.pairing import Pair, Pairing
from certreg.io.problems import read_problem
from certreg.io.springs import SpringSource
from certreg.io.streams import number
from certreg.problem.motion import Scale
from certreg.problem.support import Cell, Loss, require_supported
from certreg.registration.certification import certify
from certreg.registration.exit_codes import (
    MISUSED,
    NOT_CERTIFIED,
    NOT_UNIQUE,
    REFUSED,
    FitDemands,
    code_of_demands,
    code_of_error,
)
from certreg.registration.simulation import optimally_damped
from certreg.report.document import ERROR_SCHEMA, error_document
from certreg.report.pair_fields import document_of
from certreg.results import Limits, Optimality
from certreg.verify import shown

if TYPE_CHECKING:
    from certreg.problem.problem import RegistrationProblem


FILES = (*NEEDED, "weights", "pairs", *SPRING_FILES)
SHARD_PAIRS = 16  # at most: a second of work
LEAST_SHARDS = 64  # where there are so many pairs: all workers have work
OPTIMAL = "optimal"  # the damping of the fastest decay
UNSAFE = re.compile(r"[^A-Za-z0-9_-]+")
RESULTS = "results.jsonl"
TABLES = (RESULTS, SUMMARY, COLUMNS, PARQUET)  # made anew whenever a campaign has ended
SHOWN_ERRORS = 10  # one by one; the others are counted
STEM = 60  # characters of a pair's name in the name of its certificate
DEFAULT_LIMITS = Limits()
NOTHING_ASKED = FitDemands()
RIGID = {"scale": "none", "rotation_only": "no"}
LABELS_OPEN, NOT_ALL_PROVED = "labels-not-proved", "partly-proved"
STATUSES = (
    "certified, certified-not-unique, bounded, not-certified, or error; of wrong pairs "
    f"{LABELS_OPEN} (the most, but not each label) or {NOT_ALL_PROVED} (less)"
)
SHORT = (NOT_UNIQUE, NOT_CERTIFIED)  # exit codes of rows that are not fully proved
SHOWN_SHORT = 5  # names of each kind
LOOSE_WORDS = "1: the noise rules out no turn about some axis; 0: it does; empty: not known"
POSE_COLUMNS = ("qw", "qx", "qy", "qz", "tx", "ty", "tz")
PAIR_COLUMNS = (
    Column("name", str, "", "what the list calls the pair"),
    Column("place", str, "", "file and line of the list"),
    Column("exit_code", int, "", "what `certreg certify` would end with"),
    Column("status", str, "", STATUSES),
    Column("n", int, "points", "correspondences"),
    Column("rmse", float, "unit of the clouds", "root of the weighted mean of squared residuals"),
    Column("explained", float, "1", "R squared of the fit, with the best scale"),
    Column("best_scale", float, "1", "target over source"),
    Column("scale", float, "1", "of the pose; empty where it was not free"),
    Column("warnings", str, "", "codes of what is wrong with the fit: empty for a good one"),
    *(Column(f"q{axis}", float, "1", f"rotation: {axis} of the quaternion") for axis in "wxyz"),
    *(Column(f"t{axis}", float, "unit of the clouds", f"translation: {axis}") for axis in "xyz"),
    Column("gap_bound", float, "objective", "proved: objective - minimum is at most this"),
    Column("gap_share", float, "1", "proved: gap over the range of energies; empty if that is 0"),
    Column("angle_bound_rad", float, "rad", "proved: the optimum is nearer; empty if not unique"),
    Column("margin", float, "1", "gap of the two best eigenvalues over their range"),
    Column(
        "nearly_ambiguous",
        int,
        "",
        "1: margin below 0.001, and noise or wrong pairs may turn it; 0: no",
    ),
    Column("hardly_determined", int, "", LOOSE_WORDS),
    Column("pattern", str, "", "multiplicities of the eigenvalues: 1 1 1 1 is four equilibria"),
    Column("inliers", int, "pairs", "proved: within in every best motion; empty without bounds"),
    Column("outliers", int, "pairs", "proved: within in no best motion"),
    Column("undecided", int, "pairs", "neither is proved"),
    Column("most_within", int, "pairs", "proved: no motion brings more within; not of truncated"),
    Column("certificate", str, "", "file, from the folder of the table"),
    Column("error", str, "", "why there is no result"),
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PairCampaign(Campaign):
    """The pairs of a list; with certificates, if they are to be kept.

    limits: what must be proved of a pose to call it certified. demands: on its fit; they change
        exit codes alone, which no shard holds, and may be others when the campaign goes on.
    defaults: of the columns `scale`, `rotation_only` and those of wrong pairs, for rows that say
        nothing there.
    """

    listing: Listing
    certificates: bool
    limits: Limits = DEFAULT_LIMITS
    demands: FitDemands = NOTHING_ASKED
    defaults: dict[str, str] = field(default_factory=RIGID.copy)
    suffix: str = ".jsonl"

    def manifest(self) -> Manifest:
        """The list, where it stands, and what certifies."""
        count = self.listing.count
        return Manifest(
            kind="pairs",
            count=count,
            shard_size=max(1, min(SHARD_PAIRS, count // LEAST_SHARDS)),
            settings={
                "list": str(self.listing.path),
                "sha256": self.listing.digest,
                **asdict(self.limits),
                **self.defaults,
            },
            versions=current_versions(),
        )

    def tasks(self, done: Container[int]) -> Iterator[Task]:
        """The rows of each shard that is not done; the list is never held as a whole."""
        manifest, rows = self.manifest(), self.listing.rows()
        for shard in range(manifest.shards):
            own = tuple(map(self._filled, islice(rows, len(manifest.items(shard)))))
            if shard not in done:
                arguments = {
                    "rows": own,
                    "folder": str(self.listing.path.parent),
                    "certificates": self.certificates,
                    "limits": self.limits,
                }
                yield Task(shard=shard, function=certify_pairs, arguments=arguments)

    def inputs(self) -> Iterator[Path]:
        """All files that the rows name, those of a row after those of the row before."""
        folder = self.listing.path.parent
        return (folder / name for row in self.listing.rows() for name in _named(row))

    def _filled(self, row: PairRow) -> PairRow:
        """A row that says what the defaults do where it is empty."""
        return replace(row, fields={**self.defaults, **row.fields})

    def results(self, content: bytes) -> Iterator[tuple[str, dict[str, Any]]]:
        """The lines of a shard, and what they hold, with the exit codes that the demands give."""
        for line in content.decode().splitlines(keepends=True):
            entry: dict[str, Any] = json.loads(line)
            registered = entry["schema"] != ERROR_SCHEMA
            warned = registered and bool(entry["fit"]["warnings"])
            unmet = self.demands.unmet(entry["rmse"], warned=warned) if registered else []
            if not unmet:
                yield line, entry
                continue
            entry["exit_code"] = code_of_demands(entry["exit_code"], unmet)
            yield _line(entry), entry

    def files(self, content: bytes) -> dict[str, str]:
        """The certificates of a shard, by the digests in its lines."""
        entries = [json.loads(line) for line in content.splitlines()]
        certified = [entry for entry in entries if entry.get("certificate") is not None]
        return {Path(e["certificate"]).name: e["certificate_sha256"] for e in certified}

    def final(self, content: bytes) -> bool:
        """Whether no pair of a shard had an error, and each says what it was computed from."""
        entries = map(json.loads, content.splitlines())
        return all(e["schema"] != ERROR_SCHEMA and "inputs" in e for e in entries)

    def changed(self, content: bytes) -> Iterator[str]:
        """The files of pairs that were registered and are others now, as the list names them."""
        folder = self.listing.path.parent
        for line in content.splitlines():
            inputs: dict[str, str | None] = json.loads(line).get("inputs", {})
            yield from (n for n, digest in inputs.items() if digest_of(folder / n) != digest)


def certify_pairs(
    *, rows: tuple[PairRow, ...], folder: str, certificates: bool, limits: Limits
) -> TaskResult:
    """A line of JSON for each row, with certificates as files if they are to be kept.

    exit_code: of the proof alone.
    """
    lines: list[str] = []
    files: dict[str, bytes] = {}
    for row in rows:
        entry, certificate = _entry(row, Path(folder), limits)
        if certificates and certificate is not None:
            name = f"{row.number + 1:06d}-{UNSAFE.sub('_', row.name)[:STEM]}.json"
            files[name] = certificate
            entry["certificate"] = f"certificates/{name}"
            entry["certificate_sha256"] = hashlib.sha256(certificate).hexdigest()
            del entry["reasons"]["certificate"]
        lines.append(_line(entry))
    return TaskResult(content="".join(lines).encode(), files=files)


def _line(entry: dict[str, Any]) -> str:
    return json.dumps(entry, allow_nan=False) + "\n"


@dataclass(slots=True)
class Told:
    """Pairs of which the same is told: how many there are, and the first of them in words."""

    count: int = 0
    first: list[str] = field(default_factory=list[str])

    def add(self, words: str, most: int) -> None:
        """One more; its words, if there are fewer than `most`."""
        self.count += 1
        if len(self.first) < most:
            self.first.append(words)


class Tally:
    """What became of the pairs: how many ended with each exit code; errors, poor fits, statuses."""

    def __init__(self) -> None:
        self.codes: Counter[int] = Counter()
        self.errors, self.poor = Told(), Told()
        self.short: defaultdict[str, Told] = defaultdict(Told)  # of what is proved of them

    def add(self, entry: dict[str, Any]) -> None:
        """Count a pair by its line of results."""
        name, code = entry["name"], entry["exit_code"]
        self.codes[code] += 1
        if entry["schema"] == ERROR_SCHEMA:
            self.errors.add(f"{name}: {entry['error']['message']}", SHOWN_ERRORS)
            return
        if code in SHORT:
            self.short[_status(entry)].add(name, SHOWN_SHORT)
        if entry["fit"]["warnings"]:
            self.poor.add(f"{name}: {entry['fit']['warnings'][0]['text']}", SHOWN_ERRORS)


def write_pair_results(kind: PairCampaign, folder: Path, *, parquet: bool) -> Tally:
    """Write `results.jsonl` and the table of all pairs, and count them.

    Raises InvalidFileError, MissingToolError.
    """
    tally = Tally()

    def blocks(stream: BinaryIO) -> Iterator[Block]:
        for content in contents(kind, folder):
            rows: list[dict[str, Any]] = []
            for line, entry in kind.results(content):
                stream.write(line.encode())
                tally.add(entry)
                rows.append(_row(entry))
            yield [[row[column.name] for row in rows] for column in PAIR_COLUMNS]

    with written_atomically(folder / RESULTS) as stream:
        write_table(folder, PAIR_COLUMNS, blocks(stream), parquet=parquet)
    return tally


def _row(entry: dict[str, Any]) -> dict[str, Any]:
    """What the table says of a line of results."""
    row = {key: entry[key] for key in ("name", "place", "exit_code")}
    if entry["schema"] == ERROR_SCHEMA:
        nothing = dict.fromkeys((column.name for column in PAIR_COLUMNS), None)
        return nothing | row | {"status": "error", "error": entry["error"]["message"]}
    optimality, equilibria = entry["optimality"], entry["equilibria"]
    margin = entry["margin"]
    loose, near = margin["hardly_determined"], margin["nearly_ambiguous"]
    return row | {
        "status": _status(entry),
        "n": entry["n"],
        "rmse": entry["rmse"],
        **_fit_and_pose(entry["fit"], entry["pose"]),
        **_labels(entry),
        "gap_bound": optimality["gap_bound"],
        "gap_share": optimality["gap_share"],
        "angle_bound_rad": optimality["angle_bound_rad"],
        "margin": margin["relative"],
        "nearly_ambiguous": None if near is None else int(near),
        "hardly_determined": None if loose is None else int(loose),
        "pattern": "" if equilibria is None else " ".join(map(str, equilibria["pattern"])),
        "certificate": entry["certificate"],
        "error": None,
    }


def _status(entry: dict[str, Any]) -> str:
    """What its exit code says: of wrong pairs what is proved of all pairs, and of the fit."""
    told: dict[str, Any] = entry.get("consensus") or entry.get("truncated") or {}
    status = entry["optimality"]["status"]
    if not told:
        return status
    if told["labels_unique"]:
        one = told.get("unique", True) or status != Optimality.CERTIFIED.value
        return status if one else Optimality.CERTIFIED_NOT_UNIQUE.value
    whole = "upper" in told and told["upper"] == told["lower"]
    return LABELS_OPEN if whole else NOT_ALL_PROVED


def _labels(entry: dict[str, Any]) -> dict[str, int | None]:
    """How many labels of each kind are proved, where pairs have bounds."""
    consensus, truncated = entry.get("consensus"), entry.get("truncated")
    told: dict[str, Any] = consensus or truncated or {}
    kinds = {"inliers": "inlier", "outliers": "outlier", "undecided": "undecided"}
    labels = told.get("labels")
    counts = {column: labels and labels.count(word) for column, word in kinds.items()}
    return {**counts, "most_within": told.get("upper")}


def _fit_and_pose(fit: dict[str, Any], pose: dict[str, Any]) -> dict[str, Any]:
    numbers = [*pose["quaternion_wxyz"], *pose["translation"]]
    return {
        "explained": fit["explained"],
        "best_scale": fit["best_scale"],
        "scale": pose["scale"],
        "warnings": " ".join(warning["code"] for warning in fit["warnings"]),
        **dict(zip(POSE_COLUMNS, numbers, strict=True)),
    }


def _entry(row: PairRow, folder: Path, limits: Limits) -> tuple[dict[str, Any], bytes | None]:
    """The result of a row, or its error, and the bytes of its certificate."""
    inputs = _inputs(row, folder)  # before they are read: a later change is seen
    called = {"name": row.name, "place": str(row.place)}
    try:
        problem, pair = _problem(row, folder)
        about = {"certreg": __version__, "name": row.name, **pair.about}
        asked = asked_of_bounds(row, folder, pair)
        registration: Any = certify(problem, about=about, **asdict(limits), **asked)
    except CertregError as error:
        return error_document(error, code_of_error(error), **called), None
    except MemoryError:
        words = CertregError("not enough memory for this pair: use fewer points")
        return error_document(words, MISUSED, **called), None
    except Exception as error:  # noqa: BLE001 - a defect met by one pair must not cost the others
        words = CertregError(f"a defect of certreg ({type(error).__name__}: {shown(error)})")
        return error_document(words, REFUSED, **called), None
    document = document_of(registration, notes=pair.notes)
    document["timings_ms"] = {}  # a run that was interrupted gives the same bytes
    head = {
        "schema": document["schema"],
        **called,
        "exit_code": registration.exit_code,
        "inputs": inputs,
    }
    certificate = registration.certificate
    return head | document, None if certificate is None else certificate.to_json()


def _inputs(row: PairRow, folder: Path) -> dict[str, str | None]:
    """The SHA-256 of each file that a row names; None where it cannot be read twice."""
    return {name: digest_of(folder / name) for name in _named(row)}


def _named(row: PairRow) -> list[str]:
    """The files of a row, as the list names them."""
    names = [row.fields[field] for field in FILES if field in row.fields]
    bounds = bounds_file(row)
    return names if bounds is None else [*names, bounds]


def _problem(row: PairRow, folder: Path) -> tuple[RegistrationProblem, Pair]:
    """The problem that a row states, and how its files were read."""
    fields = row.fields
    fault = row.fault or next((f"give {n}: a file" for n in NEEDED if n not in fields), None)
    if fields.keys() >= {"sigma", "weights"}:
        fault = "sigma and weights exclude each other: give one"
    if fields.keys() >= {"pairs", "match"} and fields["match"] != Match.ALL.value:
        fault = "pairs and match exclude each other: give one"
    if fields.get("match", "all") not in {one.value for one in Match}:
        fault = f"match is '{shown(fields['match'])}': write all or common"
    if fields.get("scale", "none") not in {one.value for one in Scale}:
        fault = f"scale is '{shown(fields['scale'])}': write none, asymmetric or symmetric"
    if fields.get("rotation_only", "no") not in {"yes", "no"}:
        fault = f"rotation_only is '{shown(fields['rotation_only'])}': write yes or no"
    fault = fault or fault_of_bounds(row)
    if fault is not None:
        raise row.place.refusal(fault)
    scale, only = Scale(fields.get("scale", Scale.NONE)), fields.get("rotation_only") == "yes"
    springs = not fields.keys().isdisjoint(("springs", *SPRING_FILES))
    loss = Loss.of(fields.get("objective"), fields.get("max_residual"))
    require_supported(Cell(springs=springs, scale=scale, rotation_only=only, loss=loss))
    pairs, damping = fields.get("pairs"), fields.get("damping", OPTIMAL)
    problem, pair = read_problem(
        folder / fields["source"],
        folder / fields["target"],
        sigma=number(row.place.at("sigma"), fields["sigma"]) if "sigma" in fields else None,
        weights=folder / fields["weights"] if "weights" in fields else None,
        damping=None if damping == OPTIMAL else number(row.place.at("damping"), damping),
        pairing=Pairing(
            pairs=None if pairs is None else folder / pairs, match=Match(fields.get("match", "all"))
        ),
        springs=SpringSource(
            columns=tuple(fields.get("springs", "").split()),
            files={kind: folder / fields[kind] for kind in SPRING_FILES if kind in fields},
        ),
    )
    problem = problem.modelled(scale, rotation_only=only)
    # Of wrong pairs it is that of the pairs within, which `certify` takes by itself.
    damped = "damping" in fields and damping == OPTIMAL and "max_residual" not in fields
    return optimally_damped(problem) if damped else problem, pair
