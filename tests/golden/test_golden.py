"""The golden record sees what changed for users, and passes over times and what is meant."""

from __future__ import annotations

import base64
import gzip
import io
import re
from typing import TYPE_CHECKING

import numpy as np
import pytest
from cases import COMMANDS, cases
from commands import certreg
from comparison import Meant, compare, read_meant
from volatile import stable_file, stable_name, stable_text

if TYPE_CHECKING:
    from pathlib import Path

PLACES = {"/home/me/checkout": "CHECKOUT"}
TOLD = "$ certreg info\nexit code 0\n--- stdout\ncertreg 0.1.0\n--- stderr\n"


@pytest.fixture
def records(tmp_path: Path) -> tuple[Path, Path]:
    """Two records, the same."""
    for side in ("base", "head"):
        folder = tmp_path / side / "info" / "files"
        folder.mkdir(parents=True)
        (folder.parent / "step-00.txt").write_text(TOLD, "utf-8")
        (folder / "pose.txt.txt").write_text("1 0 0 0\n", "utf-8")
    return tmp_path / "base", tmp_path / "head"


def test_two_records_that_are_the_same_have_no_difference(records):
    found = compare(*records)

    assert (found.files, found.unmeant, found.unmet) == (2, (), ())


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("exit code 0", "exit code 1"),
        ("certreg 0.1.0", "certreg 0.1.1"),
        ("certreg 0.1.0\n", "certreg 0.1.0 \n"),
        ("--- stderr\n", "--- stderr\nnote: more\n"),
        ("--- stderr\n", "--- stderr"),
    ],
    ids=["exit code", "character", "blank", "line", "end of the last line"],
)
def test_whatever_is_printed_differently_is_a_difference(records, old, new):
    (records[1] / "info" / "step-00.txt").write_text(TOLD.replace(old, new), "utf-8")
    (difference,) = compare(*records).unmeant

    assert difference.path == "info/step-00.txt"
    assert len(difference.diff.splitlines()) > 3


def test_a_file_that_is_gone_or_new_is_a_difference(records):
    (records[1] / "info" / "files" / "pose.txt.txt").rename(records[1] / "info" / "pose.txt")
    gone, new = compare(*records).unmeant

    assert (gone.path, gone.head) == ("info/files/pose.txt.txt", None)
    assert (new.path, new.base) == ("info/pose.txt", None)
    assert {gone.diff, new.diff} == {
        "--- base/info/files/pose.txt.txt: only here\n",
        "+++ head/info/pose.txt: only here\n",
    }


def test_an_empty_file_is_not_the_same_as_none(records):
    (records[1] / "info" / "files" / "empty.txt").touch()

    assert len(compare(*records).unmeant) == 1


def test_a_difference_that_is_meant_passes_and_one_beside_it_does_not(records):
    step = records[1] / "info" / "step-00.txt"
    meant = Meant(path="info/*", found=r"certreg 0\.1\.\d", reason="a new version")
    step.write_text(TOLD.replace("0.1.0", "0.1.1"), "utf-8")
    passed = compare(*records, meant=[meant])
    for old, new in (("code 0", "code 2"), ("0.1.0", "0.2.0"), ("0.1.0\n", "0.1.1 \n")):
        step.write_text(TOLD.replace(old, new, 1), "utf-8")
        failed = compare(*records, meant=[meant])
        assert [each.path for each in failed.unmeant] == ["info/step-00.txt"]

    assert (passed.unmeant, passed.unmet) == ((), ())


def test_a_line_or_a_file_that_is_meant_may_be_new(records):
    (records[1] / "info" / "step-00.txt").write_text(f"{TOLD}note: more\n", "utf-8")
    (records[1] / "info" / "new.txt").write_text("whatever\n", "utf-8")
    meant = (
        Meant(path="info/step-*", found=r"note: .*\n", reason="it says more"),
        Meant(path="info/new.txt", found=r"(?s).*", reason="it writes more"),
    )

    found = compare(*records, meant=meant)

    assert (found.unmeant, found.unmet) == ((), ())


def test_a_difference_that_is_meant_elsewhere_does_not_pass(records):
    (records[1] / "info" / "step-00.txt").write_text(TOLD.replace("0.1.0", "0.1.1"), "utf-8")
    meant = Meant(path="help/*", found="certreg .*", reason="")

    assert len(compare(*records, meant=[meant]).unmeant) == 1


def test_an_entry_of_the_list_that_meets_nothing_is_told(records):
    (records[1] / "info" / "step-00.txt").write_text(TOLD.replace("code 0", "code 1"), "utf-8")
    meant = Meant(path="*", found="certreg .*", reason="")

    assert compare(*records, meant=[meant]).unmet == (meant,)


def test_every_entry_of_the_list_has_its_reason():
    assert all(each.reason for each in read_meant())


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ('{"timings_ms": {\n "a": 1.5,\n "b": 2}}', '{"timings_ms": {\n "a": 12.25e-3}}'),
        ('"time_ms": 0.25,', '"time_ms": 1e-05,'),
        (
            "  road  index    time      guarantee\n  x  0 1    10.52 ms  exact",
            "  road  index    time     guarantee\n  x  0 1    2.40 ms  exact",
        ),
        ("inertia   PROVED      0.15 s  Title", "inertia   PROVED     10.15 s  Title"),
        ("7 mutated statements refuted, in 0.7 s", "7 mutated statements refuted, in 12.3 s"),
        (
            "1,200 in 1.0 s: 1,187 a second; without making them 208,737, with 2 at work",
            "1,200 in 2.5 s: 480 a second; without making them 99, with 2 at work",
        ),
        ("/home/me/checkout/data.csv: no", "CHECKOUT/data.csv: no"),
    ],
)
def test_times_and_places_are_left_out(first, second):
    assert stable_text(first, PLACES) == stable_text(second, PLACES)


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("energy 10.52 J", "energy 10.53 J"),
        ('"rmse": 0.25', '"rmse": 0.250'),
        ("2 of 2 claims PROVED", "1 of 2 claims PROVED"),
        ("PROVED      0.15 s  Title", "REFUTED     0.15 s  Title"),
        ("a  b", "a b"),
    ],
)
def test_what_is_no_time_is_kept(first, second):
    assert stable_text(first, PLACES) != stable_text(second, PLACES)


def test_arrays_are_compared_to_the_bit():
    def saved(value: float) -> bytes:
        stream = io.BytesIO()
        np.savez(stream, times=np.array([0.0, value]))
        return stream.getvalue()

    assert "times float64 (2,)" in stable_file("a.npz", saved(1.0), {})
    assert stable_file("a.npz", saved(1.0), {}) != stable_file("a.npz", saved(1 + 2**-52), {})


def test_a_long_line_of_a_page_is_compared_to_the_last_character():
    page = f"<p>{'a' * 5000}</p>"
    other = stable_file("a.html", page.replace("a</p>", "b</p>").encode(), {})
    text = stable_file("a.html", page.encode(), {})

    assert text != other
    assert len(text) < 500


def test_the_certificate_in_a_page_is_compared_as_text():
    packed = base64.b64encode(gzip.compress(b'{\n "about": {}\n}\n')).decode()
    page = f'<p><script id="certificate" type="text/plain">{packed}</script>'

    assert ' "about": {}\n' in stable_file("a.html", page.encode(), {})


def test_a_shard_is_compared_with_the_one_of_the_same_number():
    assert stable_name(f"shards/00000001-{'0f' * 16}.npz") == "shards/00000001-DIGEST.npz"
    assert stable_name("certificates/000001-pair.json") == "certificates/000001-pair.json"


def test_every_command_is_recorded():
    steps = [step for case in cases() for step in case.steps]
    used = {step.arguments[0] for step in steps if step.arguments}

    told = certreg("--help").out.partition("Commands:")[2].partition("\n\n")[0]

    assert set(re.findall(r"(?m)^  (\w+)", told)) == set(COMMANDS)
    assert used >= set(COMMANDS)


def test_every_case_has_a_name_of_its_own():
    names = [case.name for case in cases()]

    assert len(names) == len(set(names))
