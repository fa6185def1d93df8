"""The proofs hold, nothing unproved slips in, and the verified checker decides as verify.py does.

What needs Coq is skipped where coqc is missing (`make proofs` installs it).
"""

from __future__ import annotations

import base64
import json
import math
import os
import re
import shutil
import struct
import subprocess
import sys
from fractions import Fraction
from importlib import import_module
from pathlib import Path

import certificates as oracle
import numpy as np
import pytest
from checker_boundaries import form
from commands import certreg

from certreg.certificate.coq import (
    ASSUMPTIONS,
    AXIOMS,
    axioms,
    axioms_in,
    compiled_proofs,
    export,
    find_coqc,
    is_compiled,
    needed,
    run_coqc,
)
from certreg.errors import MissingToolError
from certreg.registration.examples import STORIES, tell
from derivations import book
from derivations.coq import check, page
from derivations.coq.theorems import ORDER, theorems

checker = import_module("certreg.verify")
ROOT = Path(__file__).parents[2]
PROOFS, VECTORS = ROOT / "derivations" / "coq", ROOT / "vectors"
# Words in names of what it does not read.
NOT_COQS = {"consensus", "count", "rotation", "scaled", "similarity", "springs", "truncated"}
SECONDS = 5.0  # the contract: 100 points, from the command to the verdict
needs_coq = pytest.mark.skipif(
    not (os.environ.get("CERTREG_PROOFS") and shutil.which("coqc") and shutil.which("coqchk")),
    reason="compiles the proofs for minutes: `make proofs`, which installs Coq",
)


RECORDED = PROOFS / "assumptions.txt"

# Without Coq


def test_no_proof_file_claims_anything_without_proof():
    check.scan(PROOFS)


@pytest.mark.parametrize(
    "planted",
    [
        "Theorem planted : 1 = 2. Admitted.",
        "Theorem planted : 1 = 2. Proof. admit. Admitted.",
        "Axiom planted : 1 = 2.",
        "Parameter planted : 1 = 2.",
        "Conjecture planted : 1 = 2.",
        "Hypothesis planted : 1 = 2.",
        "  Variables (planted : 1 = 2).",
        "(* of no matter *) Axiom planted (* : 1 = 1 *) : 1 = 2.",
        "Unset Guard Checking.",
    ],
)
def test_a_planted_gap_is_seen_in_the_text(tmp_path, planted):
    text = (PROOFS / "Vectors.v").read_text("utf-8")
    (tmp_path / "Vectors.v").write_text(f"{text}\n{planted}\n", "utf-8")

    with pytest.raises(check.ProofError, match=r"Vectors\.v, line"):
        check.scan(tmp_path)


def test_words_in_comments_and_hypotheses_in_sections_are_no_gaps(tmp_path):
    text = "(* Admitted (* Axiom *) Parameter *)\nSection S.\nVariable x : nat.\nEnd S.\n"
    (tmp_path / "Vectors.v").write_text(text, "utf-8")

    check.scan(tmp_path)


def test_assumptions_other_than_those_recorded_and_allowed_are_refused():
    recorded = (PROOFS / "assumptions.txt").read_text("utf-8")
    check.compare(recorded, recorded)

    more = recorded.replace(": ", ": Vectors.planted, ", 1)
    for found, words in (
        (more, "assumes Vectors.planted"),
        (recorded.partition("\n")[2], "not what Coq prints"),
        (recorded + "Vectors.new: nothing\n", "not what Coq prints"),
    ):
        with pytest.raises(check.ProofError, match=words):
            check.compare(recorded, found)


def test_what_coqchk_lists_is_read_and_refused_if_it_is_not_allowed():
    good = "\nCONTEXT SUMMARY\n=====\n\n* Theory: Set is predicative\n\n* Axioms:\n" + "".join(
        f"    {axiom}\n" for axiom in check.ALLOWED
    )
    for heading in check.SAFE_HEADINGS:
        good += f"\n* Constants relying on {heading}: <none>\n"
    check.require_allowed(good)

    for bad in (
        good.replace("classic\n", "classic\n    Certreg.Vectors.planted\n"),
        good.replace("<none>", "Certreg.Vectors.planted", 1),
        good.replace("Axioms", "Something else"),
        "",
    ):
        with pytest.raises(check.ProofError, match=r"coqchk"):
            check.require_allowed(bad)


def test_every_theorem_has_its_assumptions_recorded():
    recorded = [line.partition(":")[0] for line in RECORDED.read_text("utf-8").splitlines()]

    assert recorded == sorted(f"{name}.{theorem}" for name, theorem in check.theorems(PROOFS))
    assert {f"Coq.{axiom}" for axiom in AXIOMS} <= {
        re.sub(r"^Coq\.(Reals|Logic)\.", "Coq.", axiom) for axiom in check.ALLOWED
    }


def test_the_page_shows_every_theorem_as_the_proofs_state_it():
    text = page.PAGE.read_text("utf-8")
    listed = re.findall(r"^### (\w+)$", text, re.MULTILINE)

    assert page.page(text) == text, "run python3 -m derivations.coq.page"
    assert sorted(listed) == sorted(theorem for _, theorem in check.theorems(PROOFS))
    assert sorted(ORDER) == check.names(PROOFS)


def test_every_theorem_that_the_page_names_in_its_tables_exists():
    table = page.PAGE.read_text("utf-8").partition(page.MARK)[0]
    named = set(re.findall(r"`([a-z0-9]+(?:_[a-z0-9]+)+)`", table))
    known = {theorem for _, theorem in check.theorems(PROOFS)}

    assert named - known == {"functional_extensionality_dep"}


@pytest.mark.parametrize("name", book.names())
def test_a_claim_names_theorems_that_exist_and_what_they_do_not_say(name):
    claim = book.claim(name)

    assert set(claim.coq) <= set(theorems())
    assert len(claim.coq) == len(set(claim.coq))
    assert claim.not_in_coq.strip() == claim.not_in_coq != ""
    assert claim.not_in_coq.endswith(".")
    assert set(re.findall(r"`([a-z_]+)`", claim.not_in_coq)) <= {*theorems(), *book.names()}


def test_the_table_of_levels_names_every_claim_and_its_theorems():
    table = (
        page.PAGE.read_text("utf-8")
        .partition(page.MARK)[0]
        .partition("Every claim of the project")[2]
    )
    linked = dict[str, set[str]]()
    for row in table.splitlines():
        named = set(re.findall(r"`([a-z0-9]+(?:_[a-z0-9]+)+)`", row))
        claims = re.findall(r"\(proofs/(\w+)\.md\)", row)
        for name in claims:
            linked[name] = linked.get(name, set()) | named
        beside = {theorem for name in claims for theorem in book.claim(name).coq}
        assert not claims or named <= beside, row

    assert set(linked) == set(book.names())
    for name, named in linked.items():
        assert bool(named & set(book.claim(name).coq)) == bool(book.claim(name).coq), name


def test_every_theorem_has_hypotheses_that_stand_before_its_last_arrow():
    for theorem in theorems().values():
        words = " ".join(theorem.statement.split())
        before = "".join(f"{each} -> " for each in theorem.hypotheses)

        assert f" : {before}" in words
        assert re.match(r"[^:]*(\([^)]*\)[^:]*)* : ", words)

    assert theorems()["energy_never_rises"].hypotheses[1] == "(forall p, In p l -> 0 <= weight p)"
    assert theorems()["optimal_iff_index_zero"].hypotheses == ("balanced C R",)
    assert theorems()["davenport_form"].hypotheses == ()


def test_the_checker_stands_last_in_the_order_of_compilation():
    order = needed(PROOFS)

    assert order[0] == "Vectors"
    assert order[-1] == "Checker"
    assert len(order) == len(set(order))


def test_the_exported_integers_are_the_doubles_and_the_claims():
    source, target, weights = oracle.random_problem(seed=3, n=7)
    certificate = oracle.produce(source, target, weights)
    text = export(oracle.dump(certificate)).refusal()

    rows = re.findall(r"ZPair ([^;\]]*)", text)
    powers = re.search(r"Data \(points0\) (\S+) (\S+) (\S+)\.", text)
    assert powers is not None
    ew, ex, ey = (Fraction(2) ** number(power) for power in powers.groups())
    for row, x, y, w in zip(rows, source, target, weights, strict=True):
        values = [number(word) for word in row.split()]
        assert values[0] * ew == Fraction(float(w))
        assert [v * ex for v in values[1:4]] == [Fraction(float(v)) for v in x]
        assert [v * ey for v in values[4:]] == [Fraction(float(v)) for v in y]
    for name, pair in (
        ("delta", certificate["optimality"]["delta"]),
        ("mu", certificate["optimality"]["mu"]),
        ("gap", certificate["claims"]["gap"]),
    ):
        found = re.search(rf"{name} := \(Dyadic (\S+) (\S+)\);", text)
        assert found is not None
        m, e = map(number, found.groups())
        assert m * Fraction(2) ** e == pair[0] * Fraction(2) ** pair[1]


def number(word: str) -> int:
    """An integer in Coq's words."""
    return int(word.strip("()"), 16)


@pytest.mark.slow
def test_verify_with_coq_without_coq_is_one_line_and_exit_code_2(tmp_path):
    path = VECTORS / "accept-pattern-1111.json"
    environment = {"PATH": str(tmp_path), "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "certreg", "verify", "--coq", str(path)]

    done = subprocess.run(
        command, env=environment, capture_output=True, text=True, check=False, encoding="utf-8"
    )

    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("certreg: coqc was not found: install Coq")
    assert done.stderr.count("\n") == 1


def test_verify_with_coq_of_a_missing_file_is_exit_code_2(tmp_path):
    done = certreg("verify", "--coq", tmp_path / "missing.json")

    assert done.code == 2
    assert done.err.count("\n") == 1


@pytest.mark.parametrize("kind", ["count", "consensus"])
def test_verify_with_coq_of_another_kind_is_one_line_and_exit_code_2(kind):
    done = certreg("verify", "--coq", VECTORS / f"accept-{kind}.json")

    assert done.code == 2
    assert done.out == ""
    assert done.err.count("\n") == 1
    assert f"of kind {kind}, and Coq decides on kind isotropic alone: leave out --coq" in done.err


@pytest.mark.parametrize(
    ("name", "words"),
    [
        (
            f"similarity-{scale}{alone}",
            "of kind similarity, and Coq decides on kind isotropic alone",
        )
        for scale in ("asymmetric", "symmetric")
        for alone in ("", "-rotation-only")
    ]
    + [
        (
            f"rotation-only{rest}",
            "of a rotation alone, and Coq decides where there is a translation",
        )
        for rest in ("", "-one-pair", "-all-rotations")
    ],
)
def test_verify_with_coq_of_a_free_scale_or_a_rotation_alone_is_one_line(name, words):
    """Coq knows sums about the means alone: what it would prove is of another problem."""
    done = certreg("verify", "--coq", VECTORS / f"accept-{name}.json")

    assert done.code == 2
    assert done.out == ""
    assert done.err.count("\n") == 1
    assert f"a certificate {words}: leave out --coq" in done.err


def test_out_without_coq_is_wrong_usage(tmp_path):
    path = VECTORS / "accept-pattern-1111.json"
    done = certreg("verify", path, "--out", tmp_path / "certificate.v")

    assert done.code == 2
    assert "--out goes with --coq" in done.err
    assert not list(tmp_path.iterdir())


def test_a_malformed_certificate_is_refused_before_coq_is_asked(tmp_path):
    path = tmp_path / "certificate.json"
    path.write_text("{}", "utf-8")
    done = certreg("verify", "--coq", path)

    assert done.code == 1
    assert done.out.startswith("REFUSED: the certificate must have exactly the keys")


COMPILED = b"a compiled checker"


def answering(folder: Path, axiom: str) -> str:
    """A command in the place of coqc that lists one axiom, whatever it is asked."""
    command = folder / "coqc"
    command.write_text(f"#!/bin/sh\necho 'Axioms:'\necho '{axiom} : False'\n", "utf-8")
    command.chmod(0o755)
    return str(command)


def test_what_the_checker_assumes_is_asked_once_and_again_when_it_changed(tmp_path):
    (tmp_path / "Checker.vo").write_bytes(COMPILED)
    classic, other = sorted(AXIOMS)[:2]

    assert axioms(answering(tmp_path, classic), tmp_path) == (classic,)
    assert axioms(answering(tmp_path, other), tmp_path) == (classic,)
    (tmp_path / "Checker.vo").write_bytes(COMPILED + b" of other proofs")
    assert axioms(answering(tmp_path, other), tmp_path) == (other,)
    (tmp_path / "Checker.axioms").write_bytes(b"\xff")
    assert axioms(answering(tmp_path, classic), tmp_path) == (classic,)


@pytest.mark.parametrize("axiom", ["Vectors.planted", "ClassicalDedekindReals.sig_not_decided"])
def test_a_checker_that_assumes_more_than_it_may_decides_nothing(tmp_path, axiom):
    (tmp_path / "Checker.vo").write_bytes(COMPILED)

    for _ in range(2):  # asked, and from what was kept
        with pytest.raises(MissingToolError, match=f"more than they may.*{axiom}"):
            axioms(answering(tmp_path, axiom), tmp_path)


def test_an_answer_that_lists_no_assumptions_is_no_answer():
    assert axioms_in("Closed under the global context\n") == ()
    assert axioms_in("") is None
    assert axioms_in("Axioms:\n") is None
    assert axioms_in("Theory:\nType hierarchy is collapsed (logic is inconsistent)\n") is None
    assert axioms_in("Axioms:\na.b : False\n  -> c : d\nE.f\n  : g\n") == ("a.b", "E.f")


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("late", ["Vectors.v", "Vectors.vo", "Checker.v"])
def test_proofs_of_which_a_part_is_newer_than_the_last_are_compiled_again(tmp_path, late):
    for name in needed(PROOFS):
        shutil.copyfile(PROOFS / f"{name}.v", tmp_path / f"{name}.v")
        (tmp_path / f"{name}.vo").touch()
    assert is_compiled(tmp_path, needed(PROOFS), PROOFS)

    after = (tmp_path / "Checker.vo").stat().st_mtime + 5
    os.utime(tmp_path / late, (after, after))
    assert not is_compiled(tmp_path, needed(PROOFS), PROOFS)


@pytest.mark.slow
def test_compiled_proofs_of_other_sources_are_not_taken(tmp_path):
    for name in needed(PROOFS):
        shutil.copyfile(PROOFS / f"{name}.v", tmp_path / f"{name}.v")
    (tmp_path / "Vectors.v").write_text("Axiom planted : 1 = 2.", "utf-8")
    for name in needed(PROOFS):
        (tmp_path / f"{name}.vo").touch()

    assert not is_compiled(tmp_path, needed(PROOFS), PROOFS)


# With Coq


@pytest.fixture(scope="module")
def proofs() -> Path:
    """The compiled proofs."""
    check.compile_in(check.BUILD)
    return compiled_proofs(find_coqc())


def decisions(proofs: Path, certificates: list[bytes]) -> list[list[str] | None]:
    """Reasons to refuse each certificate, all in one run of Coq; None where it is malformed."""
    source, found = "", dict[int, list[str] | None]()
    for k, certificate in enumerate(certificates):
        try:
            source += export(certificate).decision(f"_{k}")
        except checker.RefusalError:
            found[k] = None
    head = export(oracle.dump(oracle.produce(*oracle.random_problem(0, n=4)))).refusal()
    done = run_coqc(find_coqc(), proofs, head.partition("\nDefinition")[0] + source, seconds=300)
    assert done.returncode == 0, done.stderr
    for part in done.stdout.split("refused_")[1:]:
        tag, _, words = part.partition("=")
        found[int(tag)] = re.findall(r"[a-z]+_[a-z_]+", words.partition(":")[0])
    return [found[k] for k in range(len(certificates))]


def replaced(certificate, *path, value):
    forged = json.loads(json.dumps(certificate))
    part = forged
    for step in path[:-1]:
        part = part[step]
    part[path[-1]] = value
    return forged


NUMBERS = {  # values of one place of a certificate, true and false
    ("claims", "sin2_half_angle"): [[1, -200], [1, 0], [0, 0], [-1, 3], None],
    ("claims", "pattern"): [
        *([1, 1, 1, 1], [1, 2, 1], [4], [2, 2], [1, 3], [3, 1], [1], [10**40], [-1, 5]),
    ],
    ("claims", "unstable"): [
        *([0, 1, 2, 3], [0], [0, 1], [0, 3], [0, 2], [1, 2, 3, 4], [0, 1, 2, 10**40], None),
    ],
    ("claims", "unique"): [True, False],
    ("claims", "basin"): [True, False],
    ("claims", "sdp_gap"): [[1, 0]],
    ("sdp",): [{"nu": [1, 60]}, {"nu": [-1, 60]}, {"nu": None}],
    ("problem", "digest"): ["0" * 64],
    ("pose",): [[0, 0, 0, 0], [1, 0, 0, 0]],
}


def forgeries(certificate):
    """Certificates that differ in one place; most are false, a few still true."""
    for k in range(4):
        for power in (0, 20, 40, 58):
            yield replaced(certificate, "pose", k, value=certificate["pose"][k] + 2**power)
    for name in ("delta", "mu"):
        m, e = certificate["optimality"][name]
        for value in ([m, e - 20], [m, e + 1], [m, e + 20], [-m, e], [0, e]):
            yield replaced(certificate, "optimality", name, value=value)
    m, e = certificate["claims"]["gap"]
    for value in ([m, e - 1], [2 * m - 1, e - 1], [m, e + 1], [-m, e], [0, 0]):
        yield replaced(certificate, "claims", "gap", value=value)
    for path, values in NUMBERS.items():
        for value in values:
            yield replaced(certificate, *path, value=value)
    for gap in ([1, 70], [1, 10]):
        forged = replaced(certificate, "sdp", value={"nu": [1, 60]})
        yield replaced(forged, "claims", "sdp_gap", value=gap)
    content = base64.b64decode(certificate["problem"]["data"])
    numbers = np.frombuffer(content[26:], "<f8")
    for place, value in ((0, 7.25), (-1, 0.5), (-1, -0.25), (5, float("inf")), (4, -0.0)):
        changed = numbers.copy()
        changed[place] = value
        yield oracle.with_problem(certificate, content[:26] + changed.astype("<f8").tobytes())


def certificates_of_all_kinds() -> list[bytes]:
    """True ones, forged ones, and the published vectors."""
    made = [oracle.produce(*oracle.random_problem(seed=seed, n=4 + seed % 5)) for seed in range(12)]
    made += [
        oracle.produce(source, target, pattern=pattern)
        for pattern, source, target in oracle.PATTERNS.values()
    ]
    texts = [oracle.dump(certificate) for certificate in made]
    for certificate in (made[0], made[-1], made[-2]):
        texts += [oracle.dump(forged) for forged in forgeries(certificate)]
    files = [
        path
        for path in VECTORS.glob("*.json")
        if path.name != "manifest.json" and not NOT_COQS & set(path.stem.split("-"))
    ]
    texts += [path.read_bytes() for path in sorted(files)]
    moving = json.loads((VECTORS / "accept-pattern-1111.json").read_bytes())
    for shift in (-3, -1, 1, 2, 4, 40):
        for part, name, k, step in (
            ("basin", "angular_velocity", 3, shift),
            ("sdp", "nu", 1, shift),
            ("basin", "quaternion", 0, 2 ** (shift + 50)),
        ):
            value = moving[part][name][k] + step
            texts.append(oracle.dump(replaced(moving, part, name, k, value=value)))
    return texts


@needs_coq
@pytest.mark.slow
def test_the_verified_checker_answers_as_verify_does(proofs):
    certificates = certificates_of_all_kinds()
    found = decisions(proofs, certificates)
    expected = [checker.check(certificate).verified for certificate in certificates]

    assert [reasons == [] for reasons in found] == expected
    by_coq = [reasons for reasons in found if reasons]
    assert len(certificates) >= 200
    assert len(by_coq) >= 50
    assert sum(expected) >= 20
    assert len({reason for reasons in by_coq for reason in reasons}) >= 12


def spinning_states(count: int) -> list[tuple[bytes, bool]]:
    """Certificates of a body that turns, with exponents of all sizes, and whether it must end.

    Each comes twice: with the largest multiple of an angular velocity for which, by definition, the
    energy is below the level, and with the next one.
    """
    found: list[tuple[bytes, bool]] = []
    for seed in range(count):
        rng = np.random.default_rng(seed)
        source, target, weights = oracle.random_problem(seed, n=4, noise=0.1)
        source, target = (
            source * 2.0 ** rng.integers(-60, 60),
            target * 2.0 ** rng.integers(-60, 60),
        )
        made = oracle.produce(source, target, weights)
        _, C, S = oracle.exact_moments(source, target, weights)
        K, trace = oracle.rotation_form(C), S[0][0] + S[1][1] + S[2][2]
        J = [[trace * (i == j) - S[i][j] for j in range(3)] for i in range(3)]
        (d, e), (m, f) = (made["optimality"][name] for name in ("delta", "mu"))
        pose, two = made["pose"], Fraction(2)
        level = form(K, pose) / sum(c * c for c in pose) + d * two**e - m * two**f
        turned = [
            8 * c + int(k) for c, k in zip(pose, rng.integers(-(2**57), 2**57, 4), strict=True)
        ]
        spare = form(K, turned) / sum(c * c for c in turned) - level
        w = [int(k) for k in rng.integers(-9, 10, 3)]
        square = form(J, w) / 4
        assert spare > 0 < square
        # k^2 square 4^exponent < spare, for k of about so many bits:
        bits = (0, 1, 20, 200)[seed % 4]
        exponent = (math.floor(math.log2(spare / square)) >> 1) - bits
        edge = math.isqrt(math.ceil(spare / square / two ** (2 * exponent)) - 1)
        for k in (edge, edge + 1):
            state = {"quaternion": turned, "angular_velocity": [*(k * c for c in w), exponent]}
            spun = replaced(replaced(made, "basin", value=state), "claims", "basin", value=True)
            found.append((oracle.dump(spun), k == edge))
    return found


@pytest.mark.slow
def test_a_spinning_state_is_accepted_up_to_the_level_whatever_its_exponent():
    exponents = set()
    for certificate, inside in spinning_states(12):
        outcome = checker.check(certificate)
        exponents.add(json.loads(certificate)["basin"]["angular_velocity"][3])
        assert outcome.verified == inside, outcome.reason
        assert inside or outcome.reason == "claims.basin is not proved of the state in basin"

    assert min(exponents) < -100 < 20 < max(exponents)


@needs_coq
@pytest.mark.slow
def test_coq_judges_spinning_states_with_exponents_as_verify_does(proofs):
    states = spinning_states(12)

    found = decisions(proofs, [certificate for certificate, _ in states])

    assert [reasons == [] for reasons in found] == [inside for _, inside in states]
    assert {reason for reasons in found for reason in reasons or ()} == {"basin_is_not_proved"}


@needs_coq
@pytest.mark.slow
def test_coq_accepts_the_certificates_of_the_packaged_problems(proofs, tmp_path):
    assert proofs.is_dir()
    for story in STORIES:
        path = tmp_path / f"{story.name}.json"
        registration = tell(story)
        assert registration.certificate is not None
        registration.certificate.save(path)
        done = certreg("verify", "--coq", path, "--out", tmp_path / f"{story.name}.v")

        assert done.code == 0, done.out + done.err
        assert done.out.splitlines()[-1] == "VERIFIED"
        assert "Theorem certified : proved data" in (tmp_path / f"{story.name}.v").read_text(
            "utf-8"
        )


@needs_coq
@pytest.mark.slow
def test_a_forged_certificate_is_refused_by_coq_with_the_reason(proofs):
    assert proofs.is_dir()
    done = certreg("verify", "--coq", VECTORS / "refuse-gap-one-unit-too-small.json")

    assert done.code == 1
    assert done.out == "REFUSED: gap is below the bound\n"


@needs_coq
@pytest.mark.slow
def test_a_theorem_of_a_certificate_assumes_what_the_checker_does_and_no_more(proofs):
    accepted = export((VECTORS / "accept-pattern-1111.json").read_bytes())
    source = f"{accepted.theorem()}Print Assumptions certified.\n"

    of_certificate = run_coqc(find_coqc(), proofs, source, seconds=60).stdout
    of_checker = run_coqc(find_coqc(), proofs, ASSUMPTIONS, seconds=60).stdout

    assert of_certificate == of_checker
    assert set(axioms_in(of_certificate) or ()) == AXIOMS


@needs_coq
@pytest.mark.slow
def test_a_refused_certificate_has_no_theorem_even_if_it_is_claimed(proofs):
    forged = export((VECTORS / "refuse-pose-half-a-turn-off.json").read_bytes())

    done = run_coqc(find_coqc(), proofs, forged.theorem(), seconds=60)

    assert done.returncode != 0
    assert 'it is expected to have type\n "check data statement = true"' in done.stderr


@needs_coq
@pytest.mark.slow
def test_a_hundred_points_take_at_most_five_seconds(proofs, tmp_path):
    assert proofs.is_dir()
    rng = np.random.default_rng(5)
    source, weights = rng.normal(size=(100, 3)), rng.uniform(0.5, 2.0, 100)
    target = source + rng.normal(size=(100, 3)) / 50
    path = tmp_path / "certificate.json"
    path.write_bytes(oracle.dump(oracle.produce_quickly(source, target, weights)))
    before = os.times()
    assert certreg("verify", "--coq", path).code == 0
    after = os.times()

    # Processor seconds: the machine may be busy with something else.
    assert sum(after[:4]) - sum(before[:4]) <= SECONDS


UNGUARDED = """From Certreg Require Import Checker.
Axiom classic : forall P : Prop, P \\/ ~ P.
Unset Guard Checking.
Fixpoint endless (n : nat) : 1 = 2 := endless n.
Set Guard Checking.
Theorem planted : (1 = 2) /\\ (True \\/ ~ True).
Proof. exact (conj (endless 0) (classic True)). Qed.
Print Assumptions planted.
"""


@needs_coq
@pytest.mark.slow
def test_a_recursion_that_no_one_checked_is_an_assumption(proofs):
    done = run_coqc(find_coqc(), proofs, UNGUARDED, seconds=60)

    assert done.returncode == 0, done.stderr
    expected = ("endless is assumed to be guarded.", "classic")
    assert axioms_in(done.stdout) is not None
    assert sorted(axioms_in(done.stdout) or ()) == sorted(expected)
    assert sorted(check.assumed(done.stdout)) == sorted(expected)


PLANTED = """From Certreg Require Import Checker.
Theorem admitted : 1 = 2. Admitted.
Axiom gap : 1 = 2.
Theorem assumed : 1 = 2. Proof gap.
Lemma hole : 1 = 2. Admitted.
Theorem built_on_it : 2 = 1. Proof. symmetry. exact hole. Qed.
"""
GAPS = {"admitted": "admitted", "assumed": "gap", "built_on_it": "hole"}


@needs_coq
@pytest.mark.slow
def test_a_planted_gap_is_seen_by_coq_although_no_one_read_the_text(proofs, tmp_path):
    for path in proofs.glob("*.v*"):
        shutil.copy2(path, tmp_path)
    (tmp_path / "Planted.v").write_text(PLANTED, "utf-8")
    command = ["coqc", *check.FLAGS, "-R", str(tmp_path), "Certreg", str(tmp_path / "Planted.v")]
    done = subprocess.run(command, check=False, capture_output=True, text=True, encoding="utf-8")
    assert done.returncode == 0, done.stderr

    found = check.assumptions(tmp_path, [("Planted", name) for name in GAPS])
    for line in found.splitlines():
        name = line.partition(":")[0].removeprefix("Planted.")
        with pytest.raises(check.ProofError, match=f"{name} assumes Planted.{GAPS[name]}"):
            check.compare(line, line)
    command = ["coqchk", "-silent", "-o", "-norec", "Certreg.Planted"]
    summary = subprocess.run(
        [*command, "-R", str(tmp_path), "Certreg"],
        capture_output=True,
        text=True,
        check=True,
        encoding="utf-8",
    )
    for gap in GAPS.values():
        assert f"Certreg.Planted.{gap}" in summary.stderr


def test_bytes_of_minus_zero_across_two_doubles_are_no_minus_zero():
    numbers = [1.0, 0.0, 1.0 + 2.0**-45, 0.0, 1.0, 2.0]
    content = oracle.problem_bytes(numbers[:3], numbers[3:], [1.0])
    certificate = oracle.produce(*oracle.random_problem(0, n=4))
    certificate["problem"] = oracle.stated_problem(content, 1)

    assert struct.pack("<d", -0.0) in content
    assert "ZPair" in export(oracle.dump(certificate)).refusal()
    signed = content.replace(struct.pack("<2d", 0.0, 1.0), struct.pack("<2d", -0.0, 1.0))
    certificate["problem"] = oracle.stated_problem(signed, 1)
    with pytest.raises(checker.RefusalError, match=r"-0\.0"):
        export(oracle.dump(certificate))


def test_doubles_of_all_magnitudes_are_exported_exactly():
    numbers = [5e-324, 1.7e308, -2.5, 0.0, 1.0, -1e-200]
    content = oracle.problem_bytes(numbers[:3], numbers[3:], [1.0])
    certificate = oracle.produce(*oracle.random_problem(0, n=4))
    certificate["problem"] = oracle.stated_problem(content, 1)
    text = export(oracle.dump(certificate)).refusal()

    row = re.search(r"ZPair ([^;\]]*)", text)
    powers = re.search(r"Data \(points0\) (\S+) (\S+) (\S+)\.", text)
    assert row is not None
    assert powers is not None
    values = [number(word) for word in row[1].split()]
    _, ex, ey = (Fraction(2) ** number(power) for power in powers.groups())
    assert [v * ex for v in values[1:4]] == [Fraction(v) for v in numbers[:3]]
    assert [v * ey for v in values[4:]] == [Fraction(v) for v in numbers[3:]]
    assert struct.pack("<d", numbers[0]) in content
