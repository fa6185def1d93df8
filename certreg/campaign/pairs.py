"""A campaign over the user's own pairs: each is certified as `certreg certify` does it.

A pair that cannot be registered gives an object with its error, and the others go on. Its shard
is computed again when the campaign is: by then the file may be mended. So is the shard of a pair
whose files have changed: each line holds the digests of the files that it was computed from.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections import Counter
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from certreg import __version__
from certreg.campaign.calls import Call, Yield
from certreg.campaign.listing import FILES, NEEDED
from certreg.campaign.manifest import Manifest, current_versions
from certreg.campaign.running import contents, digest_of
from certreg.campaign.table import Block, Column, write_table
from certreg.errors import CertregError
from certreg.io import Match, Pairing, number, read_problem, written_atomically
from certreg.problem import DEFAULT_DAMPING
from certreg.registration import (
    MISUSED,
    REFUSED,
    certify,
    code_of_error,
    code_of_registration,
    optimally_damped,
)
from certreg.report import result_document
from certreg.settings import CampaignSettings
from certreg.verify import shown

if TYPE_CHECKING:
    from collections.abc import Container, Iterator

    from certreg.campaign.listing import Listing, PairRow
    from certreg.io import Pair
    from certreg.problem import RegistrationProblem

ERROR_SCHEMA = "certreg-error/1"
OPTIMAL = "optimal"  # the damping of the fastest decay
UNSAFE = re.compile(r"[^A-Za-z0-9_-]+")
RESULTS = "results.jsonl"
TOLD = 10  # errors that are told one by one
STEM = 60  # characters of a pair's name in the name of its certificate


PAIR_COLUMNS = (
    Column("name", str, "", "what the list calls the pair"),
    Column("place", str, "", "file and line of the list"),
    Column("exit_code", int, "", "what `certreg certify` would end with"),
    Column("status", str, "", "certified, certified-not-unique, not-certified, or error"),
    Column("n", int, "points", "correspondences"),
    Column("rmse", float, "unit of the clouds", "root of the weighted mean of squared residuals"),
    Column("gap_bound", float, "objective", "proved: the objective exceeds the minimum by less"),
    Column("angle_bound_rad", float, "rad", "proved: the optimum is nearer; empty if not unique"),
    Column("margin", float, "1", "gap of the two best eigenvalues over their range"),
    Column("nearly_ambiguous", int, "", "1: unique, but the margin is below 0.001; 0: not so"),
    Column("pattern", str, "", "multiplicities of the eigenvalues: 1 1 1 1 is four equilibria"),
    Column("certificate", str, "", "file, from the folder of the table"),
    Column("error", str, "", "why there is no result"),
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PairCampaign:
    """The pairs of a list; with certificates, if they are to be kept."""

    listing: Listing
    certificates: bool
    suffix: str = ".jsonl"

    def manifest(self) -> Manifest:
        """The list, where it stands, and what certifies."""
        settings, count = CampaignSettings(), self.listing.count
        return Manifest(
            kind="pairs",
            count=count,
            shard_size=max(1, min(settings.shard_pairs, count // settings.shard_share)),
            settings={"list": str(self.listing.path), "sha256": self.listing.digest},
            versions=current_versions(),
        )

    def calls(self, done: Container[int]) -> Iterator[Call]:
        """The rows of each shard that is not done; the list is never held as a whole."""
        manifest, rows = self.manifest(), self.listing.rows()
        for shard in range(manifest.shards):
            own = tuple(islice(rows, len(manifest.items(shard))))
            if shard not in done:
                arguments = {
                    "rows": own,
                    "folder": str(self.listing.path.parent),
                    "certificates": self.certificates,
                }
                yield Call(shard=shard, function=certified, arguments=arguments)

    def files(self, content: bytes) -> dict[str, str]:
        """The certificates of a shard, by the digests in its lines."""
        entries = [json.loads(line) for line in content.splitlines()]
        found = [entry for entry in entries if entry.get("certificate") is not None]
        return {Path(e["certificate"]).name: e["certificate_sha256"] for e in found}

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


def certified(*, rows: tuple[PairRow, ...], folder: str, certificates: bool) -> Yield:
    """A line of JSON for each row, with certificates as files if they are to be kept."""
    lines: list[str] = []
    files: dict[str, bytes] = {}
    for row in rows:
        entry, certificate = _entry(row, Path(folder))
        if certificates and certificate is not None:
            name = f"{row.number + 1:06d}-{UNSAFE.sub('_', row.name)[:STEM]}.json"
            files[name] = certificate
            entry["certificate"] = f"certificates/{name}"
            entry["certificate_sha256"] = hashlib.sha256(certificate).hexdigest()
            del entry["reasons"]["certificate"]
        lines.append(json.dumps(entry, allow_nan=False) + "\n")
    return Yield(content="".join(lines).encode(), files=files)


class Tally:
    """What became of the pairs: how many ended with each exit code, and the first errors."""

    def __init__(self) -> None:
        self.codes: Counter[int] = Counter()
        self.errors = 0
        self.first_errors: list[str] = []

    def add(self, entry: dict[str, Any]) -> None:
        """Count a pair by its line of results."""
        self.codes[entry["exit_code"]] += 1
        if entry["schema"] == ERROR_SCHEMA:
            self.errors += 1
            if len(self.first_errors) < TOLD:
                self.first_errors.append(f"{entry['name']}: {entry['error']['message']}")


def write_pair_results(kind: PairCampaign, folder: Path, *, parquet: bool) -> Tally:
    """Write `results.jsonl` and the table of all pairs, and count them.

    Raises InvalidFileError, MissingToolError.
    """
    tally = Tally()

    def blocks(stream: BinaryIO) -> Iterator[Block]:
        for content in contents(kind, folder):
            stream.write(content)
            entries = [json.loads(line) for line in content.splitlines()]
            rows = [_row(entry) for entry in entries]
            for entry in entries:
                tally.add(entry)
            yield [[row[column.name] for row in rows] for column in PAIR_COLUMNS]

    with written_atomically(folder / RESULTS) as stream:
        write_table(folder, PAIR_COLUMNS, blocks(stream), parquet=parquet)
    return tally


def _row(entry: dict[str, Any]) -> dict[str, Any]:
    """What the table says of a line of results."""
    row: dict[str, Any] = dict.fromkeys((column.name for column in PAIR_COLUMNS), None)
    row |= {key: entry[key] for key in ("name", "place", "exit_code")}
    if entry["schema"] == ERROR_SCHEMA:
        return row | {"status": "error", "error": entry["error"]["message"]}
    optimality, equilibria = entry["optimality"], entry["equilibria"]
    return row | {
        "status": optimality["status"],
        "n": entry["n"],
        "rmse": entry["rmse"],
        "gap_bound": optimality["gap_bound"],
        "angle_bound_rad": optimality["angle_bound_rad"],
        "margin": entry["margin"]["relative"],
        "nearly_ambiguous": int(entry["margin"]["nearly_ambiguous"]),
        "pattern": " ".join(map(str, equilibria["pattern"])),
        "certificate": entry["certificate"],
    }


def _entry(row: PairRow, folder: Path) -> tuple[dict[str, Any], bytes | None]:
    """The result of a row, or its error, and the bytes of its certificate."""
    inputs = _inputs(row, folder)  # before they are read: a later change is seen
    try:
        problem, pair = _problem(row, folder)
        about = {"certreg": __version__, "name": row.name, **pair.about}
        registration = certify(problem, about=about)
    except CertregError as error:
        return _error(row, error, code_of_error(error)), None
    except MemoryError:
        words = CertregError("not enough memory for this pair: use fewer points")
        return _error(row, words, MISUSED), None
    except Exception as error:  # noqa: BLE001 - a defect met by one pair must not cost the others
        words = CertregError(f"a defect of certreg ({type(error).__name__}: {shown(error)})")
        return _error(row, words, REFUSED), None
    document = result_document(registration)
    document["timings_ms"] = {}  # a run that was interrupted gives the same bytes
    head = {
        "schema": document["schema"],
        "name": row.name,
        "place": str(row.place),
        "exit_code": code_of_registration(registration),
    }
    head |= {"notes": pair.notes, "inputs": inputs}
    certificate = registration.certificate
    return head | document, None if certificate is None else certificate.to_json()


def _inputs(row: PairRow, folder: Path) -> dict[str, str | None]:
    """The SHA-256 of each file that a row names; None where it is none, as a pipe."""
    names = [row.fields[field] for field in FILES if field in row.fields]
    return {name: digest_of(folder / name) for name in names}


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
    if fault is not None:
        raise row.place.refusal(fault)
    pairs, damping = fields.get("pairs"), fields.get("damping", repr(DEFAULT_DAMPING))
    problem, pair = read_problem(
        folder / fields["source"],
        folder / fields["target"],
        sigma=number(row.place.at("sigma"), fields["sigma"]) if "sigma" in fields else None,
        weights=folder / fields["weights"] if "weights" in fields else None,
        damping=DEFAULT_DAMPING if damping == OPTIMAL else number(row.place.at("damping"), damping),
        pairing=Pairing(
            pairs=None if pairs is None else folder / pairs, match=Match(fields.get("match", "all"))
        ),
    )
    return optimally_damped(problem) if damping == OPTIMAL else problem, pair


def _error(row: PairRow, error: Exception, code: int) -> dict[str, Any]:
    """What stands in the place of a result."""
    return {
        "schema": ERROR_SCHEMA,
        "name": row.name,
        "place": str(row.place),
        "exit_code": code,
        "error": {"kind": type(error).__name__, "message": str(error)},
    }
