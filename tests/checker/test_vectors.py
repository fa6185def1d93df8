"""The published vectors are what they say, and are made anew byte for byte."""

from __future__ import annotations

import hashlib
import json
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

checker = import_module("certreg.verify")
ROOT = Path(__file__).parents[2]
VECTORS = ROOT / "vectors"
KEPT = {".json", ".txt"}
MANIFEST = json.loads((VECTORS / "manifest.json").read_bytes())["vectors"]
REASONS = {  # what the checker's words are about, by class
    "form": r"exactly the keys|list of integers|not JSON|appears twice|wrong type",
    "data": r"digest|not canonical|not of n points|not finite|negative|weight is not 1|positive"
    r"|too many sizes",
    "optimality": r"pose",
    "labels": r"^(the )?labels\b",
    "claim": r"claims\.(gap|sin2_half_angle|pattern|unstable|unique|at_most|second|indices) is",
    "cones": r"\bcaps?\b",
    "count": r"^proof",
    "list": r"\bbox(es)?\b|\bchart\b|first real line",
    "basin": r"claims\.basin",
    "sdp": r"sdp",
    "scale": r"\bscale\b|claims\.scale_",
    "consensus": r"\b(bound|fit|group|labels|pieces?|reach|row|stages?|states|steps?|upper)\b"
    r"|\bwitness\b|claims\.scale_",
}
SENTENCES = {
    name: sentences
    for part in (VECTORS / "theorems.txt").read_text("utf-8").removesuffix("\n").split("\n\n")
    for name, *sentences in [part.split("\n  ")]
}
each_vector = pytest.mark.parametrize("vector", MANIFEST, ids=lambda vector: vector["file"])


@pytest.mark.one_in(5)
@each_vector
def test_a_vector_is_accepted_or_refused_for_the_reason_it_was_made_for(vector):
    content = (VECTORS / vector["file"]).read_bytes()
    outcome = checker.check(content)

    assert hashlib.sha256(content).hexdigest() == vector["sha256"]
    assert ("VERIFIED" if outcome.verified else "REFUSED") == vector["verdict"]
    assert vector["file"].startswith("accept" if outcome.verified else "refuse")
    assert list(outcome.theorems) == SENTENCES.get(vector["file"], [])
    if not outcome.verified:
        found = {name for name, words in REASONS.items() if re.search(words, outcome.reason)}
        assert vector["reason"] in found


def test_accepted_vectors_prove_all_eight_patterns_a_basin_a_dual_bound_and_a_count():
    accepted = [
        json.loads((VECTORS / vector["file"]).read_bytes())
        for vector in MANIFEST
        if vector["verdict"] == "VERIFIED"
    ]
    claims = [each["claims"] for each in accepted if each["kind"] == "isotropic"]

    assert {each["kind"] for each in accepted} == set(checker.KINDS)
    assert len({tuple(claim["pattern"]) for claim in claims}) == 8
    assert any(claim["basin"] for claim in claims)
    assert any(claim["sdp_gap"] for claim in claims)


def test_the_folder_holds_what_the_manifest_lists_and_is_small():
    held = {file.name for file in VECTORS.glob("*.json")} - {"manifest.json"}

    assert held == {vector["file"] for vector in MANIFEST}
    assert {*SENTENCES} == {name for name in held if name.startswith("accept")}
    assert {vector["reason"] for vector in MANIFEST} == {None, *REASONS}
    assert sum(file.stat().st_size for file in VECTORS.iterdir() if file.suffix in KEPT) < 700_000


@pytest.mark.long
def test_the_vectors_are_made_anew_byte_for_byte(tmp_path: Path):
    run = subprocess.run(
        [sys.executable, "-W", "error", VECTORS / "make.py", tmp_path],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
        env={"PYTHONPATH": str(ROOT)},
        encoding="utf-8",
    )

    assert (run.returncode, run.stdout, run.stderr) == (0, "", "")
    made = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    held = {file.name: file.read_bytes() for file in VECTORS.iterdir() if file.suffix in KEPT}
    assert made == held
