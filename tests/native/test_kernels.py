"""Which compiled library is loaded, what builds it, and what is said where there is none."""

from __future__ import annotations

import ctypes
import itertools
import json
import math
import os
import re
import shutil
import subprocess
import sys
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import certreg
from engines import engine
from instructions import above_the_baseline, fused, listing_of, taken_from_the_system
from reference_engine import reference

import build_kernels
from benchmarks.rates import variants
from build_kernels import BuildError, Compiler, NoCompilerError, find_compiler
from certreg.errors import NotCompiledWarning
from certreg.native import engine as engines
from certreg.native import kernels, signatures
from certreg.native.engine import evaluator
from certreg.native.kernels import (
    BASELINE,
    LEVELS,
    Built,
    MissingLibraryError,
    VariantError,
    chosen_library,
)
from certreg.native.library import Library, loaded_library
from certreg.native.paths import STUCK, PathRules, quartic_paths
from certreg.native.sums import sums_by_exponent
from certreg.verify import shown

ROOT = Path(__file__).parents[2]
DATA = ROOT / "certreg" / "data"
CLOUDS = [str(DATA / f"survey_{name}.csv") for name in ("source", "target")]
X86 = build_kernels.X86


@pytest.fixture(scope="session")
def built() -> Built:
    """What stands in this checkout."""
    engine("library")
    return kernels.record_of(kernels.BUILT)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Instead of certreg/native/built; empty, and another one for the objects."""
    monkeypatch.delenv(kernels.VARIANT, raising=False)
    monkeypatch.setattr(kernels, "BUILT", tmp_path / "built")
    monkeypatch.delenv(build_kernels.SHARED, raising=False)
    monkeypatch.setattr(build_kernels, "OBJECTS", tmp_path / "objects")
    return tmp_path / "built"


@pytest.fixture
def copied(built: Built, folder: Path) -> Path:
    """The same with a copy of what stands in this checkout."""
    shutil.copytree(Path(kernels.__file__).parent / "built", folder)
    assert kernels.record_of(folder) == built
    return folder


def recorded(folder: Path, built: Built) -> None:
    (folder / kernels.RECORD).write_text(json.dumps(asdict(built)), "utf-8")


def refusal() -> str:
    with pytest.raises(MissingLibraryError) as told:
        chosen_library()
    words = str(told.value)
    assert "\n" not in words
    return words


# What is loaded ----------------------------------------------------------------------------------


def test_the_widest_that_the_processor_runs_is_loaded(copied, built):
    path, words = chosen_library()
    widest = kernels.runnable(built, copied)[-1]

    assert path == copied / built.variants[widest]
    assert words == f"{widest}, {built.compiler}"
    assert loaded_library.__wrapped__().words == f"compiled with the package ({words})"


@pytest.mark.parametrize("level", [1, 3, 4])
def test_no_wider_one_than_the_processor_s_level(level, copied, built, monkeypatch):
    monkeypatch.setattr(kernels, "_level", lambda _: level)

    assert kernels.runnable(built, copied) == [
        name for name in built.variants if LEVELS[name] <= level
    ]


def test_another_variant_can_be_named(copied, built, monkeypatch):
    for name in kernels.runnable(built, copied):
        monkeypatch.setenv(kernels.VARIANT, name)
        assert chosen_library()[0] == copied / built.variants[name]

    monkeypatch.setenv(kernels.VARIANT, "python")
    assert refusal() == "CERTREG_VARIANT is python"


def test_a_variant_that_the_processor_does_not_run_is_refused(copied, monkeypatch):
    assert copied.exists()
    monkeypatch.setattr(kernels, "_level", lambda _: 1)
    monkeypatch.setenv(kernels.VARIANT, "x86-64-v4")

    words = "which this processor or build lacks: give baseline or python"
    with pytest.raises(VariantError, match=f"^CERTREG_VARIANT is x86-64-v4, {words}$"):
        chosen_library()


@pytest.mark.parametrize("named", list(LEVELS))
def test_a_variant_is_refused_where_nothing_is_built(named, folder, monkeypatch):
    monkeypatch.setenv(kernels.VARIANT, named)
    assert not folder.exists()

    words = "but certreg's C code is not built: run `make kernels`"
    with pytest.raises(VariantError, match=f"^CERTREG_VARIANT is {named}, {words}"):
        chosen_library()


@pytest.mark.usefixtures("anew")
@pytest.mark.parametrize("named", ["x86_64_v3", "BASELINE", "no\nname"])
def test_a_variant_that_is_none_is_refused_with_the_names_there_are(named, monkeypatch):
    monkeypatch.setenv(kernels.VARIANT, named)
    run = certreg("info")

    choice = "give baseline, x86-64-v3, x86-64-v4 or python"
    assert (run.code, run.out) == (2, "")
    assert run.err == f"certreg: CERTREG_VARIANT is {shown(named)}: {choice}\n"


@pytest.mark.one_in(2)
@pytest.mark.slow
@pytest.mark.parametrize("command", ["certify", "simulate"])
def test_no_command_that_computes_takes_a_variant_that_is_none(command, tmp_path):
    run = subprocess.run(
        [sys.executable, "-m", "certreg", command, *CLOUDS],
        env={**os.environ, kernels.VARIANT: "v3", "PYTHONPATH": str(ROOT)},
        cwd=tmp_path,
        capture_output=True,
        check=False,
        encoding="utf-8",
    )

    choice = "give baseline, x86-64-v3, x86-64-v4 or python"
    assert (run.returncode, run.stdout) == (2, "")
    assert run.stderr == f"certreg: CERTREG_VARIANT is v3: {choice}\n"


@pytest.mark.skipif(not X86 or sys.platform != "linux", reason="x86-64 and /proc/cpuinfo only")
def test_the_level_is_what_the_system_says_of_the_processor(built):
    words = set(
        Path("/proc/cpuinfo").read_text("utf-8").partition("flags")[2].partition("\n")[0].split()
    )
    third = {"avx", "avx2", "bmi1", "bmi2", "f16c", "fma", "abm", "movbe", "sse4_2", "xsave"}
    fourth = {"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"}
    expected = 1 if not third <= words else 3 if not fourth <= words else 4

    assert kernels._level.__wrapped__(kernels.BUILT / built.processor) == expected


def every_variant(built: Built) -> list[Library]:
    found: list[Library] = []
    for name in kernels.runnable(built, kernels.BUILT):
        handle = signatures.opened(kernels.BUILT / built.variants[name])
        found.append(Library(handle, name, signatures.generated()))
    return found


def test_every_variant_computes_what_the_generated_python_does(built):
    rng = np.random.default_rng(7)
    for one in every_variant(built):
        for name, shape in one.shapes.items():
            given = [rng.uniform(0.5, 1.0, size) for size in shape.arguments]
            pairs = zip(one.evaluate(name, *given), reference().evaluate(name, *given), strict=True)
            for mine, other in pairs:
                np.testing.assert_allclose(mine, other, rtol=1e-9, atol=1e-9, err_msg=one.words)


def test_every_variant_tracks_paths_to_the_same_ends(built):
    """Of sum a_i q_i^4 to the same with a real: each path to its own line."""
    signs = [s for s in itertools.product((0, 1, -1), repeat=4) if next(filter(None, s), 0) == 1]
    a, b = np.exp(1j * np.arange(4.0)), np.array([1.0, 0.8, 0.7, 0.6])
    quartic = np.zeros(35)
    quartic[[0, 20, 30, 34]] = b
    steps = {
        "first_step": 0.1,
        "predictor_bound": 0.05,
        "predictor_aim": 0.01,
        "corrector_bound": 0.002,
        "least_growth": 0.5,
        "most_growth": 3.0,
        "shrink": 0.4,
        "least_step": 1e-9,
        "endgame": 1e-14,
        "polished": 1e-12,
    }
    rules, short = (PathRules(**steps, max_rounds=most, polishings=5) for most in (300, 2))
    roots, ends = (np.array(signs) / np.sqrt(numbers) for numbers in (a, b))
    begun = np.concatenate([roots, np.full((40, 1), 4.0)], axis=1)
    ends /= np.linalg.norm(ends, axis=1, keepdims=True)
    for one in every_variant(built):
        found = quartic_paths(quartic, a, begun, rules, one)
        assert found is not None
        assert not found.codes.any()
        assert (found.changes <= rules.polished).all()
        assert (found.conditions < 1e3).all()
        early = quartic_paths(quartic, a, begun, short, one)
        assert early is not None
        assert (early.codes == STUCK).all()
        assert np.abs((found.points[:, :4].conj() * ends).sum(axis=1)) == pytest.approx(1.0)


def test_every_variant_finds_the_same_exact_sums(built):
    rng = np.random.default_rng(8)
    source, target = rng.normal(size=(2, 50, 3))
    weights = rng.uniform(size=50)
    found = [sums_by_exponent(one, source, target, weights) for one in every_variant(built)]

    assert all(each == found[0] for each in found)


# What is said where there is none ----------------------------------------------------------------


def test_where_nothing_is_built_the_remedy_is_named(folder):
    assert not folder.exists()

    assert refusal() == f"certreg's C code is not built: {kernels.REMEDY}"
    assert "make kernels" in kernels.REMEDY


class Installed:
    """A distribution in a folder."""

    def __init__(self, root: Path) -> None:
        self.locate_file = root.joinpath


@pytest.mark.parametrize("same", [True, False])
def test_a_checkout_where_nothing_is_built_runs_what_is_installed_of_the_same_sources(
    same, folder, built, tmp_path, monkeypatch
):
    """`pip install .`, and Python started in the checkout, where its package is found first."""
    installed = tmp_path / "site-packages" / "certreg" / "native" / "built"
    shutil.copytree(Path(kernels.__file__).parent / "built", installed)
    digest = built.digest if same else "0" * 64
    recorded(installed, replace(built, digest=digest, checkout=False))
    site_packages = Installed(tmp_path / "site-packages")
    monkeypatch.setattr("importlib.metadata.distribution", lambda _: site_packages)
    assert not folder.exists()

    if same:
        assert kernels.chosen_library()[0].parent == installed
    else:
        assert refusal() == f"certreg's C code is not built: {kernels.REMEDY}"


@pytest.mark.parametrize("content", [b"", b"[]", b'{"digest": "a"}', b"\xff"])
def test_a_damaged_record_is_as_none(content, copied):
    (copied / kernels.RECORD).write_bytes(content)

    assert refusal().startswith("certreg's C code is not built: ")


def test_sources_that_changed_are_not_served_by_what_was_built(copied, built):
    recorded(copied, replace(built, digest="0" * 64))

    assert refusal() == f"certreg's C code differs from what was built: {kernels.REMEDY}"


def test_every_c_file_counts_in_the_digest(tmp_path, monkeypatch):
    before, files = (
        kernels.source_digest(),
        {path.name for path in (*kernels.UNITS, *kernels.HEADERS)},
    )
    here = {
        path.name for place in (kernels.HERE, kernels.GENERATED) for path in place.glob("*.[ch]")
    }
    assert files == here - {"processor.c", "example.c"}

    for name in ("UNITS", "HEADERS"):
        paths = getattr(kernels, name)
        (tmp_path / "changed.c").write_bytes(paths[-1].read_bytes() + b"\n")
        monkeypatch.setattr(kernels, name, (*paths[:-1], tmp_path / "changed.c"))
        assert kernels.source_digest() != before
        monkeypatch.setattr(kernels, name, paths)
    monkeypatch.setattr(kernels, "FLAGS", (*kernels.FLAGS, "-g"))
    assert kernels.source_digest() != before


def test_of_an_installed_package_the_sources_are_not_read(copied, built, monkeypatch):
    recorded(copied, replace(built, checkout=False, digest="0" * 64))
    monkeypatch.setattr(kernels, "source_digest", lambda: pytest.fail("read"))

    assert chosen_library()[0].exists()


@pytest.fixture
def anew():
    """Nothing is loaded yet, and what the test loads is forgotten."""
    loaded_library.cache_clear()
    yield
    loaded_library.cache_clear()


@pytest.mark.usefixtures("anew")
def test_why_nothing_was_compiled_is_said_once_and_the_generated_python_runs(copied, built):
    recorded(copied, replace(built, variants={}, why="no compiler anywhere"))

    with pytest.warns(NotCompiledWarning, match="no compiler anywhere: simulating in Python"):
        found = engines.current_engine.__wrapped__()
    assert found is evaluator()
    assert "\nsimulation   in Python: no compiler anywhere\n" in certreg("info").out


@pytest.mark.usefixtures("anew")
def test_info_names_the_variant_and_the_compiler(copied, built):
    widest = kernels.runnable(built, copied)[-1]

    line = f"\nsimulation   compiled with the package ({widest}, {built.compiler})\n"
    assert line in certreg("info").out


@pytest.mark.parametrize("content", [b"", b"garbage"])
def test_a_damaged_library_is_a_message(content, copied, built):
    path, _ = chosen_library()
    path.write_bytes(content)

    with pytest.raises(MissingLibraryError, match=r"cannot be loaded \(.*\): run `make kernels`"):
        loaded_library.__wrapped__()


def test_a_library_without_its_functions_is_a_message(copied, built):
    path, _ = chosen_library()
    path.unlink()
    shutil.copy(copied / built.processor, path)

    with pytest.raises(MissingLibraryError, match=r"lacks certreg_\w+: run `make kernels`"):
        loaded_library.__wrapped__()


@pytest.mark.slow
def test_nothing_is_written_to_or_read_from_the_user_s_folders(tmp_path, built):
    home = tmp_path / "home"
    home.mkdir(mode=0o500)
    code = (
        "import sys; from certreg.cli.main import main\n"
        f"sys.argv[1:] = ['certify', {str(DATA / 'survey_source.csv')!r},"
        f" {str(DATA / 'survey_target.csv')!r}]; main()"
    )
    given = {"HOME": str(home), "TMPDIR": str(home), "PYTHONPATH": str(ROOT), "PATH": ""}
    run = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=False,
        env=given,
        encoding="utf-8",
    )

    assert (run.returncode, run.stderr) == (0, "")
    assert list(home.iterdir()) == []


# What builds it ----------------------------------------------------------------------------------


@pytest.fixture
def pretend(built: Built, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Makes a compiler that copies what was built, after it has done what is given."""
    made = Path(kernels.__file__).parent / "built"
    monkeypatch.setattr(build_kernels, "_try", lambda _: None)

    def make(first: str = "") -> Path:
        script = tmp_path / "pretend"
        lines = [
            "#!/bin/sh",
            'for target; do :; done; echo "$*" >> "$0.log"',
            first,
            'case "$*" in',
            "  *--version) echo pretend 1.0;;",
            f'  *processor*) cp {made / built.processor} "$target";;',
            '  *" -c "*) echo object > "$target";;',
            f'  *) cp {made / built.variants[BASELINE]} "$target";;',
            "esac",
        ]
        script.write_text("\n".join(lines) + "\n", "utf-8")
        script.chmod(0o755)
        monkeypatch.setenv("CC", str(script))
        return script.with_suffix(".log")

    return make


@pytest.mark.slow
def test_a_build_fills_the_folder_and_removes_what_stood_there(pretend, folder):
    pretend()
    folder.mkdir()
    (folder / "kernels-of-yesterday.so").write_text("old", "utf-8")
    found = build_kernels.renewed()

    assert found == kernels.record_of(folder)
    assert found.checkout
    assert found.compiler == "pretend 1.0"
    assert list(found.variants) == (list(LEVELS) if X86 else [BASELINE])
    names = {kernels.RECORD, found.processor, *found.variants.values()}
    assert {path.name for path in folder.iterdir()} == names
    assert chosen_library()[0].exists()


@pytest.mark.slow
def test_what_is_built_of_its_sources_is_left_alone(pretend, folder):
    log = pretend()
    found = build_kernels.renewed()
    log.unlink()

    assert build_kernels.renewed() == found
    assert not log.exists()
    next(iter(folder.glob("kernels-*"))).unlink()
    assert build_kernels.renewed() == found
    assert log.exists()
    assert len(list(folder.glob("kernels-*"))) == len(found.variants)


@pytest.mark.long
def test_another_compiler_that_is_asked_for_builds_anew(pretend, folder, monkeypatch):
    log = pretend()
    assert build_kernels.renewed().asked == os.environ["CC"]
    monkeypatch.setenv("CC", f"{os.environ['CC']} -m64")
    log.unlink()
    found = build_kernels.renewed(set_up=False)

    assert folder.exists()
    assert log.read_text("utf-8").startswith("-m64 ")
    log.unlink()
    assert build_kernels.renewed() == found
    monkeypatch.delenv("CC")  # any will do
    assert build_kernels.renewed() == found
    assert not log.exists()


@pytest.mark.slow
def test_only_what_changed_is_compiled_again(pretend, folder, tmp_path, monkeypatch):
    log = pretend()
    before = build_kernels.renewed()
    changed = tmp_path / "sums.c"
    changed.write_bytes(kernels.UNITS[-1].read_bytes() + b"/* changed */\n")
    monkeypatch.setattr(kernels, "UNITS", (*kernels.UNITS[:-1], changed))
    log.unlink()
    after = build_kernels.renewed()

    assert folder.exists()
    assert after.digest != before.digest
    units = re.findall(r" -c (\S+)", log.read_text("utf-8"))
    assert units == [str(changed)] * len(after.variants)
    objects = list((tmp_path / "objects").iterdir())
    assert len(objects) == len(kernels.UNITS) * len(after.variants)


@pytest.mark.slow
def test_builds_share_their_objects_in_a_folder_that_is_named(
    pretend, folder, tmp_path, monkeypatch
):
    monkeypatch.setenv(build_kernels.SHARED, str(tmp_path / "shared"))
    log = pretend()
    (tmp_path / "shared").mkdir()
    (tmp_path / "shared" / "of-another-compiler.o").touch()
    found = build_kernels.renewed()
    log.unlink()
    again = build_kernels.build(tmp_path / "wheel", checkout=False)

    assert folder.exists()
    assert again == replace(found, checkout=False)
    assert " -c " not in log.read_text("utf-8")  # linked and tried only
    assert not (tmp_path / "objects").exists()
    assert (tmp_path / "shared" / "of-another-compiler.o").exists()


@pytest.mark.slow
@pytest.mark.skipif(not X86, reason="of x86-64")
def test_a_compiler_that_does_not_know_a_level_makes_the_others(pretend, folder):
    pretend('case "$*" in *x86-64-v4*-c*) echo "error: bad value" >&2; exit 1;; esac')

    assert list(build_kernels.renewed().variants) == [BASELINE, "x86-64-v3"]
    assert folder.exists()


@pytest.mark.slow
def test_a_library_that_does_not_run_is_not_taken(pretend, folder, monkeypatch):
    def crashing(path: Path) -> None:
        if BASELINE not in path.name:
            raise BuildError("it crashed")

    pretend()
    monkeypatch.setattr(build_kernels, "_try", crashing)
    monkeypatch.setattr(kernels, "_level", lambda _: 4)

    assert list(build_kernels.renewed().variants) == [BASELINE]
    assert folder.exists()


@pytest.mark.slow
def test_the_trial_is_a_process_of_its_own(built, copied):
    assert built.variants
    build_kernels._try(chosen_library()[0])

    with pytest.raises(BuildError, match="undefined symbol: certreg_"):
        build_kernels._try(copied / built.processor)


@pytest.mark.parametrize(
    ("does", "words"),
    [
        ("echo first; echo 'fatal error: no luck' >&2; exit 1", "no luck"),
        ("exit 3", "code 3"),
        ("kill -9 $$", "code -9"),
    ],
)
def test_a_compiler_that_fails_says_why(does, words, pretend, folder, monkeypatch):
    monkeypatch.setattr(build_kernels, "_fetched_zig", no_index)
    pretend(f'case "$*" in *--version) ;; *) {does};; esac')
    found = build_kernels.renewed()

    assert found.variants == {}
    assert found.why.startswith("certreg's C code was not compiled at set-up (pretend failed: ")
    assert words in found.why
    assert found.why.endswith("; no index)")
    assert [path.name for path in folder.iterdir()] == [kernels.RECORD]
    assert refusal() == found.why


def no_index(_: Path) -> Compiler:
    raise BuildError("no index")


@pytest.mark.slow
def test_code_that_is_wrong_asks_for_no_other_compiler_in_the_tests(pretend, folder, monkeypatch):
    monkeypatch.setattr(build_kernels, "_fetched_zig", lambda _: pytest.fail("fetched"))
    pretend('case "$*" in *" -c "*) echo "error: wrong" >&2; exit 1;; esac')

    assert "error: wrong" in build_kernels.renewed(set_up=False).why
    assert folder.exists()


@pytest.mark.slow
def test_set_up_tries_again_where_there_was_no_compiler_and_the_tests_do_not(
    pretend, folder, monkeypatch
):
    monkeypatch.setattr(build_kernels, "_fetched_zig", no_index)
    monkeypatch.setenv("CC", "no-such-compiler -m64")
    none = build_kernels.renewed()
    assert "no C compiler found: no-such-compiler -m64; no index" in none.why

    pretend()
    assert build_kernels.renewed(set_up=False) == none
    assert build_kernels.renewed().variants
    assert folder.exists()


def test_a_build_can_be_required(folder, monkeypatch, capsys):
    monkeypatch.setattr(build_kernels, "_fetched_zig", no_index)
    monkeypatch.setenv("CC", "no-such-compiler")
    monkeypatch.setattr(sys, "argv", ["build_kernels.py", str(folder)])
    assert build_kernels.main() == 0
    assert "no C compiler found: no-such-compiler; no index" in capsys.readouterr().out

    monkeypatch.setenv(build_kernels.REQUIRED, "1")
    assert build_kernels.main() == 1
    assert not kernels.record_of(folder).checkout


@pytest.mark.slow
def test_an_index_that_cannot_be_reached_is_a_reason(tmp_path, monkeypatch):
    pytest.importorskip("pip", reason="uv set this environment up")
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.delenv("PIP_FIND_LINKS", raising=False)

    with pytest.raises(BuildError, match=r"ERROR: .*ziglang"):
        build_kernels._fetched_zig(tmp_path)


def test_a_named_compiler_is_found_with_its_arguments(pretend, tmp_path, monkeypatch):
    pretend()
    monkeypatch.setenv("CC", f"{os.environ['CC']} -m64 '-D A'")
    assert find_compiler() == Compiler(
        command=(str(tmp_path / "pretend"), "-m64", "-D A"), words="pretend 1.0"
    )

    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(NoCompilerError):
        find_compiler()


def test_every_compiler_is_told_the_level_in_its_own_words(monkeypatch):
    zig = Compiler(command=("zig", "cc"), words="", zig=True)
    assert zig.level("x86-64-v3") == ("-mcpu=x86_64_v3",)
    assert zig.level(BASELINE) == ("-mcpu=baseline",)

    monkeypatch.setattr(build_kernels, "X86", True)
    assert Compiler(command=("cc",), words="").level("x86-64-v3") == ("-march=x86-64-v3",)
    assert Compiler(command=("cc",), words="").level(BASELINE) == ("-march=x86-64",)
    monkeypatch.setattr(build_kernels, "X86", False)
    assert Compiler(command=("cc",), words="").level(BASELINE) == ()


@pytest.mark.slow
@pytest.mark.skipif(not X86, reason="of x86-64")
def test_every_command_of_a_build_names_its_level(pretend, folder):
    """Links, too: Zig compiles what it links for the processor that it is told."""
    log = pretend()
    build_kernels.renewed()
    made = log.read_text("utf-8").splitlines()[1:]  # the first asks for the version

    assert folder.exists()
    assert len(made) == 1 + len(LEVELS) * (len(kernels.UNITS) + 1)
    for line in made:
        level = re.search(rf"/[\w-]+?-({'|'.join(LEVELS)})[-.]\S+$", line)
        named = level[1] if level else BASELINE
        assert re.findall(r"-march=(\S+)", line) == [named.replace(BASELINE, "x86-64")]


# Instructions ------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.skipif(not (X86 and shutil.which("objdump")), reason="of x86-64, read by objdump")
def test_the_baseline_holds_no_instruction_that_a_processor_may_lack(built):
    libraries = {name: kernels.BUILT / file for name, file in built.variants.items()}

    for path in (libraries.pop(BASELINE), kernels.BUILT / built.processor):
        assert above_the_baseline(listing_of(path)) == []
    for path in libraries.values():
        assert {"vaddpd", "mulx"} <= set(above_the_baseline(listing_of(path)))


@pytest.mark.slow
@pytest.mark.skipif(not (X86 and shutil.which("objdump")), reason="of x86-64, read by objdump")
def test_no_variant_fuses_operations_or_asks_the_system_for_what_rounds(built):
    """So bits do not depend on the processor: libm's sines are chosen by it."""
    memory = {"calloc", "free", "malloc", "memcpy", "memmove", "memset", "qsort"}
    exact = {"ceil", "fmax", "fmin", "frexp", "ldexp", "rint", "__stack_chk_fail"}
    for name in built.variants.values():
        assert fused(listing_of(kernels.BUILT / name)) == []
        assert taken_from_the_system(kernels.BUILT / name) <= memory | exact
    assert (
        fused("  1:\tvfmaddsub132pd %ymm1,%ymm0,%ymm0\n  2:\tvfnmadd231sd (%rax),%xmm1,%xmm0") != []
    )


@pytest.mark.parametrize("half", [0.0, 1e-300, 5e-4, 0.5, np.nextafter(0.5, 1.0), 1.5, 3.0])
def test_sine_and_cosine_are_those_of_the_system_to_the_last_bits(half):
    cosine = ctypes.c_double()
    function = loaded_library().handle.certreg_sine
    sine = function(half, ctypes.byref(cosine))

    doubled = 0.0 if half <= 0.5 else 5e-16
    assert sine == pytest.approx(math.sin(half), rel=4e-16, abs=doubled)
    assert cosine.value == pytest.approx(math.cos(half), rel=4e-16, abs=doubled)
    assert function(-half, ctypes.byref(cosine)) == -sine


@pytest.mark.long
def test_every_variant_gives_the_same_bytes(built):
    """A pair of each kind in processes of their own; 400 by `make rates NAME=variants`."""
    here = kernels.runnable(built, kernels.BUILT)
    found = {name: variants.digests_of(kernels.BUILT, name, 1) for name in (here[0], here[-1])}

    assert found[here[0]] == found[here[-1]]
    assert set(found[here[0]]) == set(variants.KINDS)


@pytest.mark.parametrize(
    "line",
    [
        *("vzeroupper", "vaddpd %xmm1,%xmm0,%xmm0", "{evex} vpdpbusd %ymm2,%ymm1,%ymm0"),
        *("kmovb  %eax,%k1", "korb   %k0,%k2,%k0", "lock cmpxchg16b (%rdi)", "popcnt %rax,%rax"),
        *("lzcnt  %rdx,%rdx", "mulx   %rax,%rcx,%rdx", "shlx   %rax,%rdx,%rdx"),
        *("haddpd %xmm0,%xmm0", "movddup (%rax),%xmm0", "pshufb %xmm1,%xmm0"),
        *("roundsd $0x9,%xmm0,%xmm0", "blendvpd %xmm0,%xmm2,%xmm1", "pcmpgtq %xmm1,%xmm0"),
        *("pmulld %xmm1,%xmm0", "pinsrq $0x1,%rax,%xmm0", "ptest  %xmm0,%xmm0"),
    ],
)
def test_an_instruction_above_the_baseline_is_found(line):
    assert above_the_baseline(f"    1000:\t{line}\n") != []


@pytest.mark.parametrize(
    "line",
    [
        *("rep ret", "tzcnt  %rax,%rax", "pinsrw $0x1,%eax,%xmm0", "cvtsi2sdq (%rax),%xmm0"),
        *("call   2032 <vaddpd@plt>", "data16 cs nopw 0x0(%rax,%rax,1)", "mulpd  %xmm1,%xmm0"),
        *("mov    0xa0fc5(%rip),%rax        # a2fd0 <vaddpd>", "pshufd $0xee,%xmm0,%xmm1"),
    ],
)
def test_an_instruction_of_the_baseline_is_none_above_it(line):
    assert above_the_baseline(f"    1000:\t{line}\n") == []


@pytest.mark.long
def test_a_wheel_with_libraries_is_for_this_platform_and_any_python(pretend, tmp_path):
    pytest.importorskip("hatchling", reason="the build backend is not installed")
    from hatchling.builders.wheel import WheelBuilder

    from hatch_build import BUILT, KernelsHook

    pretend()
    config: Any = WheelBuilder(str(ROOT)).config
    hook = KernelsHook(str(ROOT), {}, config, config.builder.metadata, str(tmp_path), "wheel")
    data: dict[str, Any] = {"force_include": {}, "pure_python": True}
    hook.initialize("standard", data)
    ((made, place),) = data["force_include"].items()

    assert place == BUILT == str(kernels.HERE.relative_to(ROOT) / "built")
    assert not kernels.record_of(Path(made)).checkout
    assert data["pure_python"] is False
    assert re.fullmatch(r"py3-none-[a-z0-9_]+", data["tag"])
    hook.finalize("standard", data, "")
    assert not Path(made).exists()


# Widths ------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_no_integer_that_c_and_python_share_has_a_width_of_the_system():
    """`long` has 32 bits on 64-bit Windows, where ctypes.c_long and NumPy's int_ follow it."""
    for path in (*kernels.UNITS, *kernels.HEADERS, kernels.PROCESSOR):
        code = re.sub(r"/\*.*?\*/", "", path.read_text("utf-8"), flags=re.DOTALL)
        assert not re.search(r"\blong\b|\bsize_t \w+[;,]", code), path.name
    for path in (ROOT / "certreg").rglob("*.py"):
        assert not re.search(r"\bc_u?long\b|\bc_s?size_t\b|np\.int_\b", path.read_text("utf-8")), (
            path
        )
