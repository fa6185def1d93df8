"""Mutated certificates of both kinds: none is accepted unless it is true, none makes it raise."""

from __future__ import annotations

import json
import random

import pytest
from checker_mutants import FILE

from benchmarks.rates import compare_checkers

TEXT = FILE.read_text(encoding="utf-8")
ONE_PER_CENT = compare_checkers.COUNT // 100
NOT_ISOTROPIC = (
    "consensus",
    "springs",
    "scaled",
    "similarity",
    "rotation-only",
    "truncated",
)  # words in names of files


@pytest.mark.slow
@pytest.mark.parametrize(
    "count", [ONE_PER_CENT // 4, pytest.param(3 * ONE_PER_CENT, marks=pytest.mark.long)]
)
def test_a_mutated_certificate_is_refused_unless_all_its_claims_are_true(count: int):
    checker = compare_checkers.loaded(TEXT, "checker_as_shipped")
    rng, certificates = random.Random(7), compare_checkers.originals()
    asked = accepted = 0
    for _ in range(count):
        content = compare_checkers.mutated(certificates, rng)
        verified, theorems, reason = compare_checkers.answer(checker, content, None)

        assert verified == bool(theorems) == (not reason)
        assert reason.isascii()
        alone = b'"isotropic"' in content and b'"consensus"' not in content  # which may hold one
        asked += alone  # as the definition beside
        if verified and alone:
            accepted += 1
            moved = b'"rotation_only"' not in content  # which has a translation
            assert not moved or compare_checkers.is_true(json.loads(content)), content

    assert asked > count // 5
    assert accepted > asked // 20


@pytest.mark.slow
def test_the_vectors_are_accepted_by_definition_exactly_where_the_manifest_says_so():
    vectors = json.loads((compare_checkers.VECTORS / "manifest.json").read_bytes())["vectors"]
    for vector in vectors:
        if any(word in vector["file"] for word in NOT_ISOTROPIC):
            continue  # the definition here is that of the isotropic kind
        if vector["reason"] in {None, "claim", "optimality", "basin", "sdp"}:
            content = (compare_checkers.VECTORS / vector["file"]).read_bytes()
            true = compare_checkers.is_true(json.loads(content))
            assert true == (vector["verdict"] == "VERIFIED"), vector["file"]


@pytest.mark.slow
@pytest.mark.one_in(4)
@pytest.mark.parametrize(
    "change",
    [
        (">= 2 * delta", "> 2 * delta"),
        ("claims.gap is below", "claims.gap falls below"),
        ("exceeds the global minimum by {told}", "is above the global minimum by {told}"),
        ("57.295779514", "59"),
    ],
)
def test_another_verdict_reason_or_sentence_is_seen(change):
    assert TEXT.count(change[0]) == 1
    base = compare_checkers.loaded(TEXT, "checker_of_base")
    head = compare_checkers.loaded(TEXT.replace(*change), "checker_of_head")
    files = sorted(compare_checkers.VECTORS.glob("*-*.json"))
    # General springs take nine tenths of the time, and none of these changes is theirs.
    vectors = [path.read_bytes() for path in files if "springs" not in path.name]
    exact = json.loads((compare_checkers.VECTORS / "accept-pattern-1111.json").read_bytes())
    delta = exact["optimality"]["delta"]
    exact["claims"]["gap"] = [delta[0], delta[1] + 1]
    vectors.append(json.dumps(exact).encode())

    assert compare_checkers.compare(base, base, iter(vectors)).total() >= len(vectors)
    with pytest.raises(compare_checkers.DifferentError):
        compare_checkers.compare(base, head, iter(vectors))
