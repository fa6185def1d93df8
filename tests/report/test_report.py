"""The report says what was computed, embeds the certificate, and is made of nothing unescaped."""

from __future__ import annotations

import base64
import errno
import gzip
import hashlib
import html
import json
import math
import os
import re
import shutil
from array import array
from dataclasses import replace
from html.parser import HTMLParser
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import certreg, checked, write_csv
from hypothesis import example, given
from hypothesis import strategies as st
from jinja2 import UndefinedError
from markupsafe import Markup
from strategies import ZOO, random_rotation

from certreg.dynamics.trajectory import Trajectory
from certreg.geometry.so3 import quaternion_from_matrix, quaternions_from_matrices
from certreg.native.loops import Integrator
from certreg.problem.problem import RegistrationProblem
from certreg.registration.agreement import Agreement
from certreg.registration.certification import certify
from certreg.registration.examples import STORIES, stated, tell
from certreg.registration.pipeline import Asked
from certreg.registration.squares import certified_squares
from certreg.report.any_report import EMBEDDED_BYTES
from certreg.report.markup import asset, coded, environment_of, inert, inert_json
from certreg.report.page import Report
from certreg.report.pages import html_page
from certreg.report.reload import MotionOptions, _problem, report_of
from certreg.report.sentences import THEOREMS
from certreg.report.thinning import simulated_escapes, thinned
from certreg.report.viewer import Names
from certreg.report.words import sentences
from certreg.verify import Clouds

if TYPE_CHECKING:
    from certreg.registration.result import Registration


ROOT = Path(__file__).parents[2]
DATA = Path(__file__).parents[2] / "certreg" / "data"
SURVEY = ("survey_source.csv", "survey_target.csv")


class Outline(HTMLParser):
    """The elements of a page and their texts, as a browser would take them."""

    def __init__(self, content: bytes) -> None:
        super().__init__()
        self.blocks = dict[str, str]()  # of scripts, by their id; "" has none
        self.tags = list[str]()
        self.words = ""
        self._inside: str | None = None
        self.feed(content.decode())

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        given = dict(attrs)
        if tag in {"script", "style"}:
            self._inside = tag if tag == "style" else (given.get("id") or "")
            self.blocks[self._inside] = ""
        if given.get("http-equiv"):
            self.policy = given["content"] or ""

    def handle_endtag(self, tag: str) -> None:
        if tag in {"script", "style"}:
            self._inside = None

    def handle_data(self, data: str) -> None:
        if self._inside is None:
            self.words += data
        else:
            self.blocks[self._inside] += data

    @property
    def certificate(self) -> bytes:
        return gzip.decompress(base64.b64decode(self.blocks["certificate"]))

    @property
    def scene(self) -> dict[str, Any]:
        return json.loads(self.blocks["scene"])


@pytest.fixture(scope="module")
def survey() -> Registration:
    return tell(STORIES[0])


@pytest.fixture(scope="module")
def written(tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("survey")
    run = certreg("certify", *(DATA / name for name in SURVEY), "--out", out, "--no-relaxation")
    assert run.code == 0
    return out


@pytest.fixture
def folder(written: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(written, tmp_path, dirs_exist_ok=True))


def test_the_quaternions_of_many_frames_are_those_of_one_at_a_time():
    rng = np.random.default_rng(5)
    half_turns = [np.diag(signs) for signs in ([1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1])]
    rotations = np.array([*half_turns, *(random_rotation(rng) for _ in range(200))])
    single = np.array([quaternion_from_matrix(R) for R in rotations])

    assert quaternions_from_matrices(rotations).tobytes() == single.tobytes()


PLANTED = environment_of(
    {
        "words": '<p title="{{ value }}">{{ words }}<b>{{ words | coded }}</b></p>',
        "missing": "{{ nothing }}",
    }.__getitem__
)


@pytest.mark.slow
@given(words=st.text(), value=st.text())
@example(words="</p><script>", value='"><img src=x onerror=1>')
@example(words="{{ 7 * 7 }}{% raw %}", value="{{ words }}")
def test_every_text_is_escaped(words: str, value: str):
    made = PLANTED.get_template("words").render(words=words, value=value)
    title, text = (
        html.escape(each).replace("&quot;", "&#34;").replace("&#x27;", "&#39;")
        for each in (value, words)
    )
    start, _, code = made.partition("<b>")

    assert start == f'<p title="{title}">{text}'
    assert re.sub(r"</?code>|`", "", code) == f"{text}</b></p>".replace("`", "")


def test_a_value_that_a_template_lacks_is_an_error():
    with pytest.raises(UndefinedError, match="nothing"):
        PLANTED.get_template("missing").render()


@pytest.mark.parametrize(
    ("words", "shown"),
    [
        ("a `b < c` d", "a <code>b &lt; c</code> d"),
        ("`a``b`", "<code>a</code><code>b</code>"),
        ("it`s", "it`s"),
        ("`a` it`s", "<code>a</code> it`s"),
    ],
)
def test_code_in_words_is_set_as_code(words: str, shown: str):
    assert coded(words) == shown


@pytest.mark.slow
@given(st.dictionaries(st.text(), st.text()))
def test_no_data_end_their_block(document: dict[str, str]):
    block = inert_json(document)

    assert json.loads(block) == document
    assert "<" not in block
    assert "<" not in inert("</script><!--")


def test_an_asset_that_would_end_its_own_element_is_refused():
    for content in ("a </script b", "</SCRIPT>", "<!-- a"):
        with pytest.raises(ValueError, match="would end"):
            asset("script", content)
    assert isinstance(asset("script", "a < b"), Markup)


def test_html_is_written_in_templates_alone():
    def tags(path: Path) -> list[str]:
        return re.findall(
            r"</?(?:a|b|p|div|li|td|tr|span|table|svg|html)[ >]", path.read_text("utf-8")
        )

    modules = [path for path in (ROOT / "certreg").rglob("*.py") if path.name != "markup.py"]
    found = {path: tags(path) for path in modules}
    templates = list((ROOT / "certreg").rglob("templates/*.html"))

    assert {path: words for path, words in found.items() if words} == {}
    assert all(tags(path) for path in templates)
    assert not any(
        re.search(r"\|\s*safe|autoescape", path.read_text("utf-8")) for path in templates
    )


def test_the_policy_admits_these_two_texts_and_nothing_else(survey: Registration):
    outline = Outline(html_page(Report.of(survey)))
    hashes = {
        kind: base64.b64encode(hashlib.sha256(outline.blocks[name].encode()).digest()).decode()
        for kind, name in (("style-src", "style"), ("script-src", ""))
    }

    assert outline.policy.split("; ") == [
        "default-src 'none'",
        f"style-src 'sha256-{hashes['style-src']}'",
        f"script-src 'sha256-{hashes['script-src']}'",
        "img-src data:",
        "base-uri 'none'",
        "form-action 'none'",
    ]


@pytest.mark.slow
def test_the_certificate_stands_in_the_page_byte_by_byte(folder: Path):
    content = (folder / "certificate.json").read_bytes()
    outline = Outline((folder / "report.html").read_bytes())

    assert outline.certificate == content
    assert json.loads(content)["problem"]["digest"] in outline.words


def test_the_words_are_those_of_the_summary_and_the_checker(survey: Registration):
    words = re.sub(r"\s+", " ", Outline(html_page(Report.of(survey))).words)

    assert "The global optimum, and unique, to within the proved bounds." in words
    for sentence in checked(survey.verdict).theorems:
        assert sentence in words
    pose = "the pose given below with all digits, by its quaternion and its translation,"
    assert f"{pose} exceeds the minimum by at most 1.51e-26." in words
    assert "within 3.98e-18 degrees" in words


@pytest.mark.one_in(4)
@pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)
def test_what_is_not_unique_is_said_first(specimen):
    registration = certify(specimen.problem, relaxation=False, simulation=False)
    words = Outline(html_page(Report.of(registration))).words
    ambiguity = registration.equilibria.classification.ambiguity

    assert ("CERTIFIED, BUT NOT UNIQUE" in words) == (ambiguity is not None)
    if ambiguity is not None:
        place = words.index(ambiguity.value[1:])
        assert place < words.index("RMSE")
        assert "The best rotation is not unique" in words


@pytest.mark.slow
@given(*[st.none() | st.floats(0.0, 180.0)] * 2)
def test_a_method_that_ends_elsewhere_is_not_said_to_lead_here(
    survey: Registration, relaxation: float | None, simulation: float | None
):
    angles = {"relaxation": relaxation, "simulation": simulation}
    turns = [None if one is None else math.radians(one) for one in (relaxation, simulation)]
    agreement = Agreement(closed_form=1e-11, relaxation=turns[0], simulation=turns[1])
    solution = replace(survey.solution, agreement=agreement)
    found, body = replace(survey, solution=solution), checked(survey.certificate).body
    said = [one.words for one in sentences(found, body) if "roads lead" in one.words]
    agreeing, _, others = said[0].partition("°. ")

    assert len(said) == 1
    names = {"relaxation": "relaxation", "simulation": "for this page (splitting, damping 2.82241)"}
    for name, angle in ((names[key], angle) for key, angle in angles.items()):
        near = angle is not None and angle <= 0.1
        assert (name in agreeing) == near
        assert (f"{name} does not: it ended {angle:.3g}°" in others if angle else False) == (
            angle is not None and not near
        )


def test_every_theorem_has_its_page_under_its_title():
    from derivations.book import CHAPTERS

    names = {name for chapter in CHAPTERS for name in chapter.names}
    for name, title in THEOREMS.items():
        text = (ROOT / "docs" / "proofs" / f"{name}.md").read_text("utf-8")
        assert name in names
        assert f"# {title}\n" in text


@pytest.mark.slow
def test_with_documentation_the_theorems_are_links(survey: Registration):
    made = html_page(Report.of(survey, documentation="../")).decode()

    assert '<a href="../proofs/optimality_certificate.html">The optimality certificate</a>' in made
    assert "<a " not in html_page(Report.of(survey)).decode()


@pytest.mark.slow
def test_the_report_again_is_the_same_and_says_how_the_motion_is_computed(
    data: Path, tmp_path: Path
):
    pair = [data / name for name in SURVEY]
    for options, words in {
        (): "the motion is computed anew, with damping 2.82241 and integrator splitting",
        ("--damping", "1.5", "--no-relaxation"): "computed anew, with damping 1.5 and integrator",
        ("--no-simulation",): "made without a simulation: no motion is computed anew",
    }.items():
        assert certreg("certify", *pair, *options, "--out", tmp_path).code == 0
        first = (tmp_path / "report.html").read_bytes()
        for name in ("result.json", "trajectory.npz"):
            (tmp_path / name).write_text("not read", "utf-8")
        run = certreg("report", tmp_path / "certificate.json", "--out", tmp_path / "again.html")

        assert run.code == 0
        assert re.fullmatch(rf"note: [^\n]*{re.escape(words)}[^\n]*\n", run.err)
        assert (tmp_path / "again.html").read_bytes() == first


@pytest.mark.slow
def test_a_motion_by_another_integrator_is_shown_again(tmp_path: Path):
    asked = Asked(simulation=Integrator.SPLITTING)
    registration = certified_squares(stated(STORIES[0]), asked)
    certificate = checked(registration.certificate)
    certificate.save(tmp_path / "certificate.json")
    again = report_of(tmp_path / "certificate.json")

    assert certificate.about["integrator"] == "splitting"
    assert html_page(again) == html_page(Report.of(registration))


@pytest.mark.parametrize(
    "about",
    [
        {},
        {"integrator": "euler"},
        {"damping": 2.0, "integrator": "leapfrog"},
        {"damping": 2.0, "integrator": ["euler"]},
        {"damping": 0.0, "integrator": "euler"},
        {"damping": 1e300, "integrator": "euler"},
        {"damping": "2", "integrator": "euler"},
        {"damping": 2, "integrator": "euler"},
    ],
)
def test_a_certificate_that_names_no_usable_motion_gets_the_usual_one(about: dict[str, Any]):
    motion = MotionOptions.of(about, RegistrationProblem([[1.0, 0.0, 0.0]], [[1.0, 0.0, 0.0]]))

    assert (motion.damping, motion.integrator) == (None, "splitting")
    assert "computed anew with the defaults, optimal damping and splitting" in motion.words


def test_an_old_certificate_gets_its_report(folder: Path):
    file = folder / "certificate.json"
    document = json.loads(file.read_bytes())
    del document["about"]["damping"], document["about"]["integrator"]
    file.write_text(json.dumps(document), "utf-8")
    first = Outline((folder / "report.html").read_bytes())
    run = certreg("report", file)

    assert run.code == 0
    assert "names no damping and integrator" in run.err
    again = Outline((folder / "report.html").read_bytes())
    assert again.scene == first.scene
    assert again.certificate == file.read_bytes()


def test_the_report_of_a_certificate_without_points_asks_for_them(folder: Path, data: Path):
    pair = [data / name for name in SURVEY]
    file = folder / "certificate.json"
    document = json.loads(file.read_bytes())
    document["problem"]["data"] = None
    file.write_text(json.dumps(document), "utf-8")
    first = Outline((folder / "report.html").read_bytes())

    run = certreg("report", file)
    assert (run.code, run.out) == (2, "")
    assert re.fullmatch(r"certreg: [^\n]*holds no points[^\n]*: give SOURCE TARGET, too\n", run.err)
    other = certreg("report", file, *reversed(pair))
    assert other.code == 1
    assert "REFUSED" in other.err
    assert certreg("report", file, pair[0]).code == 2
    assert certreg("report", file, "--sigma", "1").code == 2

    assert certreg("report", file, *pair).code == 0
    again = Outline((folder / "report.html").read_bytes())
    assert again.scene == first.scene
    assert "sample" in again.blocks


def test_the_points_of_a_page_are_those_of_the_problem_wherever_they_come_from():
    """From the certificate's own data, or from the clouds beside one without."""
    rng = np.random.default_rng(9)
    x, y = rng.normal(size=(2, 5, 3))
    for weights in (None, rng.uniform(0.5, 2.0, 5)):
        problem = RegistrationProblem(x, y, weights=weights)
        certificate = checked(certify(problem, relaxation=False, simulation=False).certificate)
        given_weights = None if weights is None else array("d", weights)
        clouds = Clouds(array("d", x.ravel()), array("d", y.ravel()), given_weights)

        assert certificate.data is not None
        assert _problem(certificate, None).digest() == problem.digest()
        assert _problem(replace(certificate, inline=None), clouds).digest() == problem.digest()


def weak_claims(document: dict[str, Any]) -> None:
    """Claims of less, of the same proof."""
    document["claims"] |= {"gap": [1, 61], "sin2_half_angle": [1, -2], "unstable": None}
    document["claims"] |= {"basin": None, "sdp_gap": None}
    document["radius"] = None


def weak_proof(document: dict[str, Any]) -> None:
    """The pose where the source was given, and a gap that any pose has."""
    weak_claims(document)
    document["pose"] = [1, 0, 0, 0]
    document["optimality"] = {"delta": [1, 60], "mu": [0, 0]}
    document["claims"] |= {"sin2_half_angle": None, "unique": False}


@pytest.mark.parametrize(
    ("weaken", "angle"),
    [
        (weak_claims, "its rotation is within 60.1 degrees of the best one"),
        (weak_proof, "of its angle to the best one they say nothing"),
    ],
)
def test_no_more_is_said_to_be_proved_than_the_certificate_in_the_page_proves(
    folder: Path, weaken: Any, angle: str
):
    file = folder / "certificate.json"
    strong = re.sub(r"\s+", " ", Outline((folder / "report.html").read_bytes()).words)
    document = json.loads(file.read_bytes())
    weaken(document)
    file.write_text(json.dumps(document), "utf-8")
    assert certreg("report", file).code == 0
    outline = Outline((folder / "report.html").read_bytes())
    words = re.sub(r"\s+", " ", outline.words)

    assert outline.certificate == file.read_bytes()
    assert words.startswith(" Bounded")
    assert "stamp open" in (folder / "report.html").read_text("utf-8")
    assert words.index("BOUNDED") < words.index(angle) < words.index("RMSE")
    for claim in ("1.51e-26", "3.98e-18", "The global optimum, and", "growing modes: whatever"):
        assert claim in strong
        assert claim not in words
    assert "by at most 2.31e+18" in words  # 2^61
    assert "fits these points better" not in words
    assert "rounding of the translation" not in words  # which the large gap is not due to
    assert "can end nowhere but at the optimum" not in words
    assert "The best rotation is unique" in words  # by the pattern, which the checker decides


class Full:
    """A file on a disk that is full after some bytes."""

    def __init__(self, stream: Any, room: list[int]) -> None:
        self.stream, self.room = stream, room

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_: object) -> None:
        self.stream.close()

    def writelines(self, parts: Any) -> None:
        for part in parts:
            self.room[0] -= len(part)
            if self.room[0] < 0:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            self.stream.write(part)


@pytest.mark.one_in(4)
@pytest.mark.parametrize("room", [0, 3_000, 10_000, 20_000])
def test_a_full_disk_leaves_the_files_of_the_run_before(
    folder: Path, data: Path, monkeypatch: pytest.MonkeyPatch, room: int
):
    def contents() -> dict[str, bytes]:
        return {file.name: file.read_bytes() for file in folder.iterdir()}

    real, before, left = os.fdopen, contents(), [room]
    monkeypatch.setattr(os, "fdopen", lambda *args: Full(real(*args), left))
    pair = (data / "abeta_2beg_model01.csv", data / "abeta_2beg_model02.csv")
    run = certreg("certify", *pair, "--no-relaxation", "--out", folder)

    assert (run.code, run.out) == (2, "")
    assert str(folder) in run.err
    assert "No space left" in run.err
    assert contents() == before


@pytest.mark.slow
@pytest.mark.one_in(3)
@pytest.mark.parametrize("broken", range(5))
def test_a_failure_between_two_files_leaves_none_of_another_problem(
    folder: Path, data: Path, monkeypatch: pytest.MonkeyPatch, broken: int
):
    def stands(file: Path) -> bytes | None:
        return file.read_bytes() if file.exists() else None

    names = [file.name for file in folder.iterdir()]
    before = {name: stands(folder / name) for name in names}
    count, real = [0], Path.replace

    def fails(self: Path, target: Path) -> Path:
        count[0] += 1
        if count[0] == broken + 1:
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        return real(self, target)

    monkeypatch.setattr(Path, "replace", fails)
    pair = (data / "abeta_2beg_model01.csv", data / "abeta_2beg_model02.csv")
    run = certreg("certify", *pair, "--no-relaxation", "--out", folder)

    assert (run.code, run.out) == (2, "")
    assert str(folder) in run.err
    assert not (folder / "certificate.json").exists()
    assert all(stands(folder / name) != before[name] for name in names)
    assert sum((folder / name).exists() for name in names) == broken
    assert not list(folder.glob(".*"))


@pytest.mark.parametrize("name", ["certificate.json", "trajectory.npz"])
def test_a_link_among_the_files_of_a_folder_is_refused_and_nothing_changes(
    folder: Path, data: Path, name: str
):
    precious = folder / "precious"
    (folder / name).rename(precious)
    (folder / name).symlink_to(precious)
    before = {file.name: file.read_bytes() for file in folder.iterdir()}
    pair = (data / "abeta_2beg_model01.csv", data / "abeta_2beg_model02.csv")
    run = certreg("certify", *pair, "--no-relaxation", "--no-simulation", "--out", folder)

    assert (run.code, run.out) == (2, "")
    assert f"{folder / name}: is a link where a file is to be: remove it" in run.err
    assert run.err.count("\n") == 1
    assert {file.name: file.read_bytes() for file in folder.iterdir()} == before


def test_a_folder_may_be_reached_by_a_link(folder: Path, data: Path):
    (folder / "link").symlink_to(folder / "real")
    (folder / "real").mkdir()
    pair = (data / "survey_source.csv", data / "survey_target.csv")
    place = folder / "link"
    run = certreg("certify", *pair, "--no-relaxation", "--no-simulation", "--out", place)

    assert run.code == 0
    assert (folder / "real" / "certificate.json").is_file()


@pytest.mark.parametrize("link", [None, Path.symlink_to, Path.hardlink_to])
def test_the_certificate_is_not_overwritten_by_its_report(folder: Path, link: Any):
    file = folder / "certificate.json"
    content, out = file.read_bytes(), file if link is None else folder / "out.html"
    if link is not None:
        link(out, file)
    run = certreg("report", file, "--out", out)

    assert (run.code, run.out) == (2, "")
    assert re.fullmatch(r"certreg: [^\n]*would overwrite [^\n]*\n", run.err)
    assert file.read_bytes() == out.read_bytes() == content


@pytest.mark.parametrize("given", ["relative", "absolute", "beside"])
def test_the_certificate_is_not_overwritten_under_any_name_of_it(
    folder: Path, monkeypatch: pytest.MonkeyPatch, given: str
):
    """Beside it is where the report goes when no --out is given."""
    file, beside = folder / "certificate.json", folder / "report.html"
    content = file.read_bytes()
    monkeypatch.chdir(folder)
    if given == "beside":
        beside.unlink()
        beside.hardlink_to(file)
    near = Path("certificate.json")
    arguments = {"relative": [file, "--out", near], "absolute": [near, "--out", file]}
    run = certreg("report", *arguments.get(given, [file]))

    assert (run.code, run.out) == (2, "")
    assert "which is read: give --out another name" in run.err
    assert file.read_bytes() == content


def test_a_trajectory_of_other_data_is_not_shown(folder: Path, data: Path, tmp_path: Path):
    other = tmp_path / "other.npz"
    pair = (data / "abeta_2beg_model01.csv", data / "abeta_2beg_model02.csv")
    assert certreg("simulate", *pair, "--out", other).code == 0
    first = (folder / "report.html").read_bytes()
    shutil.copy(other, folder / "trajectory.npz")

    assert certreg("report", folder / "certificate.json").code == 0
    assert (folder / "report.html").read_bytes() == first


@pytest.mark.slow
def test_the_damping_of_the_result_is_kept(data: Path, tmp_path: Path):
    pair = [data / name for name in SURVEY]
    certreg("certify", *pair, "--damping", "0.7", "--no-relaxation", "--out", tmp_path)
    first = (tmp_path / "report.html").read_bytes()

    assert certreg("report", tmp_path / "certificate.json").code == 0
    assert (tmp_path / "report.html").read_bytes() == first
    sums = [sum(re for re, _ in c["eigenvalues"]) for c in Outline(first).scene["components"]]
    assert sums == pytest.approx([-6 * 0.7] * 4)


def test_a_refused_certificate_gives_no_report(folder: Path):
    file = folder / "certificate.json"
    document = json.loads(file.read_text("utf-8"))
    document["claims"]["pattern"] = [1, 2, 1]
    file.write_text(json.dumps(document), "utf-8")
    (folder / "report.html").unlink()
    run = certreg("report", file)

    assert run.code == 1
    assert re.fullmatch(r"certreg: [^\n]*REFUSED: claims.pattern is wrong[^\n]*\n", run.err)
    assert not (folder / "report.html").exists()


def test_what_is_no_certificate_of_a_pose_is_refused(folder: Path, data: Path):
    count = folder / "count.json"
    certreg("equilibria", *(data / name for name in SURVEY), "--out", count)
    run = certreg("report", count)
    assert (run.code, run.out) == (2, "")
    assert "kind count" in run.err
    assert "give the certificate.json" in run.err

    assert certreg("report", folder / "missing.json").code == 2
    assert certreg("report", folder / "pose.txt").code == 1


@pytest.mark.slow
def test_labels_stand_in_the_certificate_unless_they_are_too_many(tmp_path: Path):
    rng = np.random.default_rng(5)
    points = rng.normal(size=(6, 3)).tolist()
    labels = ["a,b", '<"&', "ä", "  ,", "e" * 50, "f"]
    for names, kept in ((labels, True), ([f"{name}{',' * 5000}" for name in labels], False)):
        quoted = ['"' + name.replace('"', '""') + '"' for name in names]
        source = write_csv(tmp_path / "a.csv", points, quoted)
        run = certreg("certify", source, source, "--out", tmp_path / "out", "--no-relaxation")
        about = json.loads((tmp_path / "out" / "certificate.json").read_text("utf-8"))["about"]

        assert run.code == 0
        assert about["source"] == "a.csv"
        assert ("labels" in about) == kept
        if kept:
            assert about["labels"] == [name.strip() for name in names]
            assert Outline((tmp_path / "out" / "report.html").read_bytes()).scene["labels"] == [
                name.strip() for name in names
            ]


@pytest.mark.parametrize(
    "about",
    [
        {},
        {"labels": "ab", "source": 1},
        {"labels": [1, 2], "source": None, "target": ""},
        {"labels": ["a"], "source": []},
        {"labels": {"a": 1}},
    ],
)
def test_any_about_is_borne(about: dict[str, Any]):
    names = Names.of(about, 2)

    assert names == Names(source="source", target="target", labels=None)


def test_a_run_begins_and_ends_where_the_simulation_does(survey: Registration):
    trajectory = survey.solution.trajectory
    assert isinstance(trajectory, Trajectory)
    run = thinned(trajectory)

    assert len(run.times) <= 240
    assert run.times[0] == 0.0
    assert run.times[-1] <= run.last == trajectory.times[-1]
    total = run.potential + run.kinetic
    drop = trajectory.potential[0] - trajectory.potential[-1]
    assert 0 <= total[-1] - trajectory.potential[-1] <= 2e-8 * drop
    assert np.linalg.norm(run.quaternions, axis=1) == pytest.approx(np.ones(len(run.times)))


def test_a_pushed_body_leaves_every_saddle_for_the_optimum(survey: Registration):
    runs = simulated_escapes(survey.solution, survey.problem.damping)
    best = survey.equilibria.components[0].quaternion_wxyz

    assert [run.start for run in runs] == [1, 2, 3]
    for run in runs:
        start = survey.equilibria.components[checked(run.start)].quaternion_wxyz
        assert abs(run.quaternions[0] @ start) == pytest.approx(np.cos(0.01))
        assert abs(run.quaternions[-1] @ best) == pytest.approx(1.0, abs=1e-4)


@pytest.mark.slow
def test_ten_thousand_points_make_a_file_of_at_most_a_megabyte_and_a_half():
    rng = np.random.default_rng(7)
    x = rng.normal(size=(10_000, 3))
    registration = certify(RegistrationProblem(x, x + 1.0, weights=rng.uniform(size=10_000)))
    made = html_page(Report.of(registration))

    assert len(made) <= 1_500_000
    assert Outline(made).certificate == checked(registration.certificate).to_json()


def test_a_large_certificate_is_named_in_the_page_and_not_carried(
    folder: Path, monkeypatch: pytest.MonkeyPatch
):
    content = (folder / "certificate.json").read_bytes()
    size = len(content) - 1
    monkeypatch.setattr("certreg.report.any_report.EMBEDDED_BYTES", size)
    (folder / "certificate.json").rename(folder / "my.json")
    assert certreg("report", folder / "my.json").code == 0
    made = (folder / "report.html").read_bytes()
    outline = Outline(made)

    assert "certificate" not in outline.blocks
    assert len(base64.b64decode(outline.blocks["sample"])) == 7 * 8 * 4
    assert b'id="save"' not in made
    assert "too large for a page" in outline.words
    assert hashlib.sha256(content).hexdigest() in outline.words
    assert "certreg verify my.json" in outline.words
    assert EMBEDDED_BYTES == 8 << 20


def test_three_js_comes_with_its_licence():
    script = (files("certreg.report") / "assets" / "report.js").read_text("utf-8")

    assert "Copyright © 2010-20" in script[:400]
    assert "Permission is hereby granted, free of charge" in script[:600]
