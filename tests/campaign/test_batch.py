"""`certreg batch`: each pair as `certify` does it, each broken one a clear error in its place."""

from __future__ import annotations

import csv
import json
import os
import re
import signal
import subprocess
import sys
import time
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from campaign_work import InProcess, tree
from commands import certreg, strict_json, write_csv
from jsonschema import Draft202012Validator

import certreg as package
from certreg.campaign import pairs
from certreg.campaign.listing import read_listing
from certreg.campaign.pairs import ERROR_SCHEMA, PairCampaign
from certreg.problem.posing import PosedPairs
from certreg.results import Limits

if TYPE_CHECKING:
    from certreg.campaign.workers import TaskResult

SCHEMAS = Path(package.__file__).parent / "report" / "schemas"
TURN = [1, 2, 0]


@pytest.fixture(autouse=True)
def in_process(monkeypatch):
    """No worker processes: they would each load the solver for a second."""
    monkeypatch.setattr("certreg.cli.campaigns.workers_at", lambda _: InProcess(1))


@pytest.fixture
def folder(tmp_path) -> Path:
    """Six pairs of clouds, a0 and b0 to a5 and b5."""
    rng = np.random.default_rng(0)
    for k in range(6):
        source = rng.normal(size=(6, 3))
        write_csv(tmp_path / f"a{k}.csv", source.tolist())
        target = source[:, TURN] + 0.01 * rng.normal(size=(6, 3))
        write_csv(tmp_path / f"b{k}.csv", target.tolist())
    return tmp_path


def listing(folder: Path, *rows: str, header: str = "source,target") -> Path:
    path = folder / "pairs.csv"
    path.write_text("\n".join((header, *rows)) + "\n", "utf-8")
    return path


def lines(text: str | bytes) -> list[dict]:
    return [strict_json(line) for line in text.splitlines()]


def valid(entry: dict) -> bool:
    name = entry["schema"].replace("/", "-")
    schema = json.loads((SCHEMAS / f"{name}.json").read_text("utf-8"))
    return Draft202012Validator(schema).is_valid(entry)


@pytest.mark.slow
def test_a_pair_of_a_batch_is_what_certify_makes_of_it(folder):
    path = listing(folder, "a0.csv,b0.csv,0.01", header="source,target,sigma")
    (entry,) = lines(certreg("batch", path).out)
    alone = certreg(
        "certify", folder / "a0.csv", folder / "b0.csv", "--sigma", "0.01", "--json"
    ).document

    digests = {n: sha256((folder / n).read_bytes()).hexdigest() for n in ("a0.csv", "b0.csv")}
    assert entry.pop("inputs") == digests
    for own in ("name", "place", "exit_code"):
        entry.pop(own)
    assert entry.pop("timings_ms") == {}
    assert alone.pop("timings_ms")
    assert entry == alone


@pytest.mark.slow
def test_lines_come_in_the_order_of_the_list(folder):
    rows = [f"a{k % 6}.csv,b{k % 6}.csv,p{k}" for k in range(70)]
    run = certreg("batch", listing(folder, *rows, header="source,target,name"))

    assert (run.code, run.err) == (0, "")
    assert [entry["name"] for entry in lines(run.out)] == [f"p{k}" for k in range(70)]


def test_a_table_that_a_row_reads_is_not_made_anew(folder):
    """The folder of a campaign is its own; but a cloud that was put there since is kept."""
    path = listing(folder, "a0.csv,b0.csv", "out/summary.csv,b1.csv")
    out = folder / "out"
    assert certreg("batch", path, "--out", out).code == 2  # the cloud is not there yet
    table = out / "summary.csv"
    assert certreg("batch", path, "--out", out).err.startswith(f"certreg: {table}: would overwrite")
    table.write_bytes((folder / "a1.csv").read_bytes())
    held = tree(out)
    again = certreg("batch", path, "--out", out)

    said = f"{table}: would overwrite {table}, which is read: choose another folder"
    assert (again.code, again.out, again.err) == (2, "", f"certreg: {said}\n")
    assert tree(out) == held


BROKEN = {
    "a0.csv,none.csv,,,,,,": "none.csv: cannot be read",
    "a0.csv": "1 columns, not 8: mend the row",
    ",b0.csv,,,,,,": "line 5: give source: a file",
    "a0.csv,nan.csv,,,,,,": "nan.csv, line 2, x: 'nan' is not a number: remove the row",
    "a0.csv,b0.csv,-1,,,,,": "sigma is -1.0: a standard deviation must be > 0",
    "a0.csv,b0.csv,abc,,,,,": "line 8, sigma: 'abc' is not a number",
    "a0.csv,short.csv,,,,,,": "a0.csv has 6 points, .*short.csv has 1",
    "a0.csv,b0.csv,,,,,,twin": "the name 'twin' is that of line 2, too",
    "a0.csv,b0.csv,0.1,w.txt,,,,": "sigma and weights exclude each other",
    "a0.csv,b0.csv,,,,some,,": "match is 'some': write all or common",
    "a0.csv,b0.csv,,,p.csv,common,,": "pairs and match exclude each other",
    "a0.csv,b0.csv,,,,,-2,": "damping is -2.0: it must be a positive",
    "a0.txt\u00e9,b0.csv,,,,,,": "is not known: use one of",
}


@pytest.mark.slow
def test_a_broken_pair_is_an_error_in_its_place_and_the_others_go_on(folder):
    write_csv(folder / "nan.csv", [[0.0, 0.0, 1.0], [float("nan"), 0.0, 0.0]])
    write_csv(folder / "short.csv", [[1.0, 2.0, 3.0]])
    rows = ["a1.csv,b1.csv,,,,,,twin", *BROKEN, "a2.csv,b2.csv,,,,,,last"]
    header = "source,target,sigma,weights,pairs,match,damping,name"
    run = certreg("batch", listing(folder, *rows, header=header))
    entries = lines(run.out)

    assert run.code == 2
    assert (
        run.err == f"certreg: {len(BROKEN)} of {len(rows)} pairs could not be registered: "
        'look for "error" in the results\n'
    )
    assert [entry["schema"] for entry in (entries[0], entries[-1])] == ["certreg-result/1"] * 2
    for number, (entry, (_, words)) in enumerate(zip(entries[1:-1], BROKEN.items(), strict=True)):
        assert entry["schema"] == "certreg-error/1"
        assert re.search(words, entry["error"]["message"]), entry
        assert entry["place"].endswith(f"line {number + 3}")
        assert entry["exit_code"] == 2
    assert all(map(valid, entries))


@pytest.mark.slow
def test_the_exit_code_is_the_worst_of_the_contract(folder):
    line = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]
    write_csv(folder / "line.csv", line)
    good, not_unique, broken = "a0.csv,b0.csv", "line.csv,line.csv", "a0.csv,none.csv"

    assert certreg("batch", listing(folder, good)).code == 0
    run = certreg("batch", listing(folder, good, not_unique))
    assert run.code == 3
    assert [entry["exit_code"] for entry in lines(run.out)] == [0, 3]
    assert certreg("batch", listing(folder, broken, not_unique, good)).code == 2


@pytest.mark.slow
def test_near_ambiguity_is_told_to_machines_and_leaves_the_exit_code(folder):
    rod = [[0, 0, 0], [1000, 0.001, 0], [2000, 0, 0.002], [3000, 0, 0]]
    line = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]
    seen = [[10, 5, 3], [10.003, 1005, 3], [10, 2005, 3.001], [10, 3005, 3.002]]
    for name, points in (("rod", rod), ("seen", seen), ("line", line)):
        write_csv(folder / f"{name}.csv", points)
    pairs = ("rod.csv,seen.csv", "line.csv,line.csv", "a0.csv,b0.csv", "a0.csv,none.csv")
    out = folder / "out"
    certreg("batch", listing(folder, *pairs), "--out", out)
    entries = lines((out / "results.jsonl").read_bytes())
    with (out / "summary.csv").open(encoding="utf-8") as stream:
        table = list(csv.DictReader(stream))

    assert [entry["exit_code"] for entry in entries] == [0, 3, 0, 2]
    assert [row["nearly_ambiguous"] for row in table] == ["1", "0", "0", ""]
    assert [e["margin"]["nearly_ambiguous"] for e in entries[:3]] == [True, False, False]
    assert [row["hardly_determined"] for row in table] == ["1", "", "0", ""]
    reason = entries[1]["reasons"]["margin.hardly_determined"]
    assert reason == "the optimum is not unique"
    assert all(map(valid, entries))
    alone = certreg("equilibria", folder / "rod.csv", folder / "seen.csv", "--json").document
    assert {**alone["margin"], "hardly_determined": True} == entries[0]["margin"]


def test_defects_met_by_one_pair_do_not_cost_the_others(folder, monkeypatch):
    from certreg.campaign import pairs

    real = pairs.certify

    def failing(problem, **more):
        if problem.n == 1:
            raise ZeroDivisionError("nobody thought of it")
        return real(problem, **more)

    monkeypatch.setattr(pairs, "certify", failing)
    write_csv(folder / "one.csv", [[1.0, 2.0, 3.0]])
    run = certreg("batch", listing(folder, "one.csv,one.csv", "a0.csv,b0.csv"))
    bad, good = lines(run.out)

    assert run.code == 1
    assert "a defect of certreg (ZeroDivisionError: nobody" in bad["error"]["message"]
    assert good["optimality"]["status"] == "certified"


LISTS = {
    "": "pairs.csv: there is no header: name the columns with the files of the two clouds source",
    "src,target\n": "line 1: the header (src, target) names no source: name the columns with",
    "source,target\n": "lists no pairs: add rows",
    "a.csv,b.csv\n": "the header (a.csv, b.csv) names no source and no target: name the columns",
    "source,target,source\na,b,c\n": "names source more than once: name each column once",
    'source,target\n"a,b\n': "mend the text",
    "source,target,sigm\na,b,1\n": "column 'sigm' is not known: did you mean 'sigma'?",
    "source,target,Weight,note\na,b,w,n\n": "did you mean 'weights'?",
    "source,target,dampening\na,b,1\n": "did you mean 'damping'?",
}


@pytest.mark.parametrize("text", LISTS)
def test_a_list_that_is_none_is_refused_before_anything_is_done(tmp_path, text):
    (tmp_path / "pairs.csv").write_text(text, "utf-8")
    run = certreg("batch", tmp_path / "pairs.csv", "--out", tmp_path / "out")

    assert (run.code, run.out) == (2, "")
    assert re.fullmatch(r"certreg: \S+pairs.csv[^\n]*\n", run.err)
    assert LISTS[text] in run.err
    assert not (tmp_path / "out").exists()


def test_a_list_that_is_no_text_or_not_there_is_refused(tmp_path):
    (tmp_path / "pairs.csv").write_bytes(b"source,target\n\xff\xfe,b\n")

    run = certreg("batch", tmp_path / "pairs.csv")
    assert run.code == 2
    assert re.search("line 2: .*save the file as UTF-8", run.err)
    assert certreg("batch", tmp_path / "none.csv").code == 2
    assert "is a .csv file" in certreg("batch", tmp_path / "pairs.json").err


def test_columns_that_are_not_read_are_told_once(folder):
    header = "source,target,operator,label,sigma,sigma2,date"
    path = listing(folder, "a0.csv,b0.csv,me,x,0.1,7,today", header=header)
    run = certreg("batch", path)

    assert run.err == f"note: {path}: columns not read: operator, sigma2, date\n"
    assert lines(run.out)[0]["name"] == "x"


@pytest.mark.slow
def test_the_folder_holds_lines_certificates_and_a_table(folder):
    rows = ["a0.csv,b0.csv,../../up", "a1.csv,none.csv,b", "a2.csv,b2.csv,c d\u00e9"]
    path, out = listing(folder, *rows, header="source,target,name"), folder / "out"
    run = certreg("batch", path, "--out", out)
    entries = lines((out / "results.jsonl").read_bytes())
    with (out / "summary.csv").open(encoding="utf-8") as stream:
        table = list(csv.DictReader(stream))

    assert run.code == 2
    assert "2 of 3 pairs registered" in run.out
    assert re.match("error: b: .*none.csv: cannot be read", run.err)
    assert [row["name"] for row in table] == ["../../up", "b", "c d\u00e9"]
    assert all(map(valid, entries))
    for entry, row in zip(entries, table, strict=True):
        assert entry["name"] == row["name"]
        if entry["schema"] == "certreg-error/1":
            assert row["error"] == entry["error"]["message"]
            continue
        place = out / entry["certificate"]
        assert place.parent == out / "certificates"
        assert re.fullmatch(r"[0-9]{6}-[A-Za-z0-9_-]+\.json", place.name)
        assert package.verify(place).proved
        assert strict_json(place.read_bytes())["problem"]["digest"] == entry["digest"]
        assert float(row["rmse"]) == entry["rmse"]
    assert {path.name for path in folder.parent.iterdir() if path.name.startswith("up")} == set()


def test_a_shard_with_one_error_is_not_final_whatever_the_others_are(folder):
    kind = PairCampaign(listing=read_listing(listing(folder, "a0.csv,b0.csv")), certificates=False)
    good, bad = {"schema": "certreg-result/1", "inputs": {}}, {"schema": ERROR_SCHEMA}

    def final(*entries: dict) -> bool:
        return kind.final("".join(json.dumps(entry) + "\n" for entry in entries).encode())

    assert final(good, good)
    assert not final(good, bad)
    assert not final(good, {"schema": "certreg-result/1"})


def test_each_column_of_the_table_is_what_it_is_called(folder):
    (entry,) = lines(certreg("batch", listing(folder, "a0.csv,b0.csv")).out)
    optimality = {"gap_bound": 1.0, "gap_share": 2.0, "angle_bound_rad": 3.0}
    entry["optimality"] |= optimality
    entry |= {
        "rmse": 4.0,
        "margin": {"relative": 5.0, "nearly_ambiguous": False, "hardly_determined": True},
    }
    row = pairs._row(entry)

    assert {name: row[name] for name in optimality} == optimality
    assert (row["rmse"], row["margin"], row["nearly_ambiguous"]) == (4.0, 5.0, 0)


@pytest.mark.slow
def test_what_was_mended_is_done_when_the_same_is_run_again(folder):
    path, out = listing(folder, "a0.csv,b0.csv", "a1.csv,none.csv"), folder / "out"
    assert certreg("batch", path, "--out", out).code == 2
    (folder / "none.csv").write_bytes((folder / "b1.csv").read_bytes())

    run = certreg("batch", path, "--out", out)
    assert run.code == 0
    assert run.err == "note: 1 of 2 pairs were there already\n"
    assert len(lines((out / "results.jsonl").read_bytes())) == 2
    assert certreg("batch", path, "--out", folder / "new").code == 0
    assert tree(out) == tree(folder / "new")


CHANGES = {
    "a cloud": ("b1.csv", lambda folder: (folder / "b2.csv").read_bytes(), 0),
    "weights": ("w.txt", lambda _: b"1\n1\n1\n2\n1\n1\n", 0),
    "pairs": ("p.csv", lambda _: b"0,0\n1,1\n2,2\n3,3\n", 0),
    "a cloud, which is none now": ("b1.csv", lambda _: b"1,2,3\n4,nan,6\n", 2),
    "a cloud, which is gone": ("b1.csv", None, 2),
}


@pytest.mark.slow
@pytest.mark.one_in(5)
@pytest.mark.parametrize("what", CHANGES)
def test_a_pair_whose_files_have_changed_is_computed_anew_with_a_note(folder, what):
    name, content, code = CHANGES[what]
    (folder / "w.txt").write_text("1\n2\n3\n4\n5\n6\n", "utf-8")
    (folder / "p.csv").write_text("0,0\n1,1\n2,2\n3,3\n4,4\n", "utf-8")
    rows = ["a0.csv,b0.csv,,", "a1.csv,b1.csv,w.txt,", "a2.csv,b2.csv,,p.csv"]
    path, out = listing(folder, *rows, header="source,target,weights,pairs"), folder / "out"
    assert certreg("batch", path, "--out", out).code == 0
    before = tree(out)

    for file in (folder / "a0.csv", folder / name):  # another time alone is no change
        os.utime(file, ns=(1, 1))
    run = certreg("batch", path, "--out", out)
    assert (run.code, run.err) == (0, "note: 3 of 3 pairs were there already\n")
    assert tree(out) == before
    if content is None:
        (folder / name).unlink()
    else:
        (folder / name).write_bytes(content(folder))
    run = certreg("batch", path, "--out", out)
    assert run.code == code
    assert run.err.startswith(
        f"note: {name}: changed since the last run: computed anew\n"
        "note: 2 of 3 pairs were there already\n"
    )
    assert certreg("batch", path, "--out", folder / "new").code == code
    assert tree(out) == tree(folder / "new") != before


@pytest.mark.slow
def test_one_note_tells_of_all_files_that_have_changed(folder):
    path, out = listing(folder, "a0.csv,b0.csv", "a0.csv,b1.csv"), folder / "out"
    assert certreg("batch", path, "--out", out).code == 0
    for name in ("a0.csv", "b1.csv"):
        (folder / name).write_bytes((folder / "a3.csv").read_bytes())

    run = certreg("batch", path, "--out", out)
    notes, *poor = run.err.splitlines()
    assert notes == "note: a0.csv and 1 more: changed since the last run: computed anew"
    assert poor[0].startswith("warning: pair-1: ")  # a3.csv has no pair here
    total = 'certreg: 1 of 2 pairs has a warning: look for "warning" in the results'
    assert poor[1:] == [f'{total}; "remedy" beside it says what to do']


@pytest.mark.slow
def test_parquet_goes_with_a_folder(folder):
    pytest.importorskip("pyarrow")
    path = listing(folder, "a0.csv,b0.csv", "a1.csv,none.csv")

    assert certreg("batch", path, "--parquet").code == 2
    assert certreg("batch", path, "--parquet", "--out", folder / "out").code == 2
    from pyarrow import parquet

    table = parquet.read_table(folder / "out" / "summary.parquet")
    assert table["status"].to_pylist() == ["certified", "error"]
    assert table["n"].to_pylist() == [6, None]


@pytest.mark.slow
def test_a_long_list_is_never_held_as_objects(folder):
    """Rows are drawn as workers ask for them: many cost what their bytes cost."""
    from certreg.campaign.listing import read_listing
    from certreg.campaign.pairs import PairCampaign

    rows = (f"a0.csv,b0.csv,p{k}" for k in range(20_000))
    campaign = PairCampaign(
        listing=read_listing(listing(folder, *rows, header="source,target,name")),
        certificates=False,
    )
    tasks = campaign.tasks(done=())
    first = next(tasks)

    assert campaign.manifest().shards == 1250
    assert [row.name for row in first.arguments["rows"]] == [f"p{k}" for k in range(16)]
    assert next(campaign.tasks(done=range(1200))).arguments["rows"][0].name == "p19200"


# What runs in the background of a shell is born deaf to Ctrl-C, and so are its children.
HEARING = """
import os, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
os.execv(sys.executable, [sys.executable, *sys.argv[1:]])
"""


@pytest.mark.slow
def test_ctrl_c_ends_cleanly_and_says_how_to_go_on(folder):
    rows = ["none.csv,none.csv"] * 50_000  # quickly told, by workers that load no solver
    path, out = listing(folder, *rows), folder / "out"
    root = Path(package.__file__).parents[1]
    run = subprocess.Popen(
        [
            sys.executable,
            "-c",
            HEARING,
            "-W",
            "error",
            "-m",
            "certreg",
            "batch",
            path,
            "--out",
            out,
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(root)},
        start_new_session=True,
        encoding="utf-8",
    )
    while run.poll() is None and not list((out / "shards").glob("0*")):
        time.sleep(0.01)
    os.killpg(run.pid, signal.SIGINT)
    said, complained = run.communicate(timeout=60)

    assert (run.returncode, said) == (130, "")
    assert [line for line in complained.splitlines() if line] == [
        f"{out}: what is done is kept: run the same to go on",
        "interrupted",
    ]
    assert not (out / "results.jsonl").exists()
    assert not list(out.rglob(".certreg-*"))


@pytest.mark.slow
def test_no_cell_of_the_table_is_a_formula(folder):
    """Names are the user's, and an error repeats what a file holds; JSON keeps them as they are."""
    names = ["=1+1", "+cmd", "-2+3", "@SUM(A1)", "-1.5", "a;=1"]
    rows = [f'"{name}",a{k}.csv,b{k}.csv' for k, name in enumerate(names[:-1])]
    listed = listing(folder, *rows, f"{names[-1]},a5.csv,none.csv", header="name,source,target")
    listed = listed.rename(folder / "=list.csv")
    run = certreg("batch", listed, "--out", folder / "out")

    text = (folder / "out" / "summary.csv").read_text("utf-8")
    table = list(csv.DictReader(text.splitlines()))
    assert run.code == 2
    assert [row["name"] for row in table] == ["'=1+1", "'+cmd", "'-2+3", "'@SUM(A1)", *names[4:]]
    assert {row["place"][:2] for row in table} == {"'="}
    assert [
        each["name"] for each in lines((folder / "out" / "results.jsonl").read_bytes())
    ] == names
    for separator in ",;\t":
        for row in csv.reader(text.splitlines(), delimiter=separator):
            assert not [cell for cell in row if cell[:1] in set("=+@") or cell[:2] == "-2"]


@pytest.mark.slow
def test_a_campaign_without_compiled_motions_writes_the_same(folder, monkeypatch):
    """Certificates, and documents key by key: of good pairs, of one with a wrong row, of a slip."""
    rng = np.random.default_rng(4)
    source = rng.normal(size=(20, 3))
    target = source[:, TURN] + 0.01 * rng.normal(size=(20, 3))
    spoilt = {"row": target + 4.0 * (np.arange(20) == 7)[:, None], "slip": np.roll(target, 1, 0)}
    write_csv(folder / "a.csv", source.tolist())
    for name, each in spoilt.items():
        write_csv(folder / f"{name}.csv", each.tolist())
    rows = [f"a{k}.csv,b{k}.csv" for k in range(6)] + [f"a.csv,{name}.csv" for name in spoilt]
    listed = tuple(read_listing(listing(folder, *rows)).rows())

    def written() -> TaskResult:
        return pairs.certify_pairs(
            rows=listed, folder=str(folder), certificates=True, limits=Limits()
        )

    compiled = written()
    monkeypatch.setattr(PosedPairs, "of", lambda *_: None)
    plain = written()

    assert compiled.files == plain.files
    assert lines(compiled.content) == lines(plain.content)
    found = [[each["code"] for each in one["fit"]["warnings"]] for one in lines(plain.content)]
    assert found[:6] == [[]] * 6
    assert found[6:] == [["outlier-rows"], ["shuffled"]]
