"""Every public result is short as `repr`, the command's text as `str`, and a card in a notebook."""

from __future__ import annotations

import enum
import json
import sys
import types
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import TYPE_CHECKING, Any

import commands
import matplotlib as mpl
import numpy as np
import pytest

import certreg
from certreg import results
from certreg.cli.main import COMMANDS
from certreg.report import presenting
from certreg.report.uncertainty import uncertainty_rows
from certreg.results import REPR_LENGTH

if TYPE_CHECKING:
    from collections.abc import Iterator


DATA = Path(certreg.__file__).parent / "data"
FILES = (DATA / "survey_source.csv", DATA / "survey_target.csv")
DEPTH = 8  # of attributes of attributes


@pytest.fixture(scope="module")
def problem() -> certreg.RegistrationProblem:
    return certreg.read_problem(*FILES, sigma=1.0)[0]


@pytest.fixture(scope="module")
def registration(problem) -> certreg.Registration:
    return certreg.certify(problem, about=certreg.read_problem(*FILES)[1].about)


@pytest.fixture(scope="module")
def made(problem, registration) -> dict[str, Any]:
    """What each public name gives: of a class an instance, of a function a result."""
    x = np.asarray(problem.source)[np.newaxis]
    bodies = certreg.bodies_of(x, x)
    pose = registration.pose
    return {
        "Assessment": certreg.assess(problem, np.eye(3), np.zeros(3)),
        "AssessmentSettings": certreg.AssessmentSettings(),
        "Certificate": registration.certificate,
        "Certificates": certreg.certify_many([problem.source], [problem.target]),
        "CertregError": certreg.CertregError("words"),
        "Pose": pose,
        "Registration": registration,
        "RegistrationProblem": problem,
        "Similarity": certreg.Similarity.of_pose(pose, 2.0),
        "SimulationSettings": certreg.SimulationSettings(),
        "Trajectory": registration.solution.trajectory,
        "Verdict": registration.verdict,
        "__version__": certreg.__version__,
        "assess": certreg.assess(problem, pose.rotation, pose.translation),
        "bodies_of": bodies,
        "bodies_on_springs": certreg.bodies_on_springs(x, x, normals=x + 1.0),
        "breaking_equilibria": certreg.breaking_equilibria(
            problem.source, problem.target, max_residual=20.0
        ),
        "certify": registration,
        "certify_many": certreg.certify_many([problem], relaxation=False, simulation=False),
        "equilibria": certreg.equilibria(problem, "all"),
        "gicp_information": certreg.gicp_information(np.eye(3)[None], np.eye(3)[None], np.eye(3)),
        "load": certreg.load(FILES[0]),
        "pair": certreg.pair(*FILES),
        "read_cloud": certreg.read_cloud(FILES[0]),
        "read_problem": certreg.read_problem(*FILES),
        "register": certreg.register(problem.source, problem.target),
        "simulate": certreg.simulate(problem),
        "simulate_breaking": certreg.simulate_breaking(
            problem.source, problem.target, max_residual=20.0
        ),
        "simulate_many": certreg.simulate_many(bodies),
        "solve_many": certreg.solve_many(x, x),
        "solve_many_springs": certreg.solve_many_springs(x, x, normals=x + 1.0),
        "verify": certreg.verify(registration.certificate or b""),
    }


def parts(value: Any, depth: int = DEPTH) -> Iterator[Any]:
    """A value and all of certreg's own that is reached from it."""
    if isinstance(value, (list, tuple)):
        for each in value[:3]:
            yield from parts(each, depth)
    if type(value).__module__.split(".")[0] != "certreg":
        return
    yield value
    if depth and not isinstance(value, enum.Enum):
        for name in dir(value):
            attribute = None if name.startswith("_") else getattr(value, name, None)
            if not isinstance(attribute, types.MethodType):
                yield from parts(attribute, depth - 1)


@pytest.mark.one_in(3)
@pytest.mark.parametrize("name", certreg.__all__)
def test_the_repr_of_all_that_a_public_name_gives_is_short(name, made):
    for part in parts(made[name]):
        assert len(repr(part)) <= REPR_LENGTH, type(part)
        assert "\n" not in repr(part), type(part)


def test_the_reprs_of_what_one_meets_first_say_what_it_is(registration, problem, made):
    assert repr(registration) == "<Registration: certified; n=4, rmse=5.83899; the fit: chi2>"
    assert repr(problem) == "<RegistrationProblem: n=4, sigma given>"
    assert repr(registration.equilibria) == "<EquilibriumSet: 4, of pattern 1111; exact>"
    assert repr(made["simulate"]).startswith("<Trajectory: CONVERGED after ")
    assert repr(made["Assessment"]).startswith("<Assessment: not-an-equilibrium; ")
    assert repr(made["Certificate"]).startswith("<Certificate of kind isotropic: n=4, digest=")


def test_texts_numbers_and_integers_of_any_size_are_short():
    long, large = "x" * 10_000, 10**6000
    absent = results.Absent(long)
    explained = results.Verdict(ruling=results.Ruling.REFUTED, words=long)

    assert len(repr(explained)) == REPR_LENGTH
    assert results._short(large) == "beyond doubles"
    assert results._short(long) == repr("x" * 35) + "..."
    assert results._short(b"1" * 99) == repr(b"1" * 35) + "..."
    assert results._short(absent) == "<Absent>"
    assert results._short(np.zeros((3, 2))) == "<ndarray (3, 2)>"
    assert [results._short(one) for one in (None, True, 3, 0.1)] == ["None", "True", "3", "0.1"]


# The text and the document of the command line ----------------------------------------------------


def run(*arguments: object) -> str:
    return commands.certreg(*arguments).out.removesuffix("\n")


def without_times(document: Any) -> Any:
    return {k: v for k, v in document.items() if k not in {"timings_ms", "roads"}}


@pytest.fixture(scope="module")
def pose_file(registration, tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("pose") / "pose.txt"
    np.savetxt(path, registration.pose.T_target_source, fmt="%.17g")
    return path


def same_command(
    name: str, pose: Path, result: certreg.Registration
) -> tuple[Any, tuple[Any, ...]]:
    """What Python gives and the arguments of the command that gives the same."""
    given = ("--sigma", 1.0)
    problem = certreg.read_problem(*FILES, sigma=1.0)[0]
    matrix = np.loadtxt(pose)
    return {
        "certify": (result, ("certify", *FILES, *given)),
        "equilibria": (certreg.equilibria(problem), ("equilibria", *FILES, *given)),
        "assess": (
            certreg.assess(result, matrix[:3, :3], matrix[:3, 3]),
            ("assess", *FILES, *given, "--pose", pose),
        ),
        "simulate": (
            certreg.simulate(problem, "splitting"),
            ("simulate", *FILES, *given, "--integrator", "splitting"),
        ),
    }[name]


@pytest.mark.parametrize("name", ["certify", "equilibria", "assess", "simulate"])
def test_str_and_to_dict_are_what_the_command_prints(name, pose_file, registration):
    result, arguments = same_command(name, pose_file, registration)

    assert str(result) == result.summary() == run(*arguments)
    printed = json.loads(run(*arguments, "--json"))
    assert without_times(json.loads(json.dumps(result.to_dict()))) == without_times(printed)


def test_several_searches_are_printed_with_their_table(problem):
    result, printed = (
        certreg.equilibria(problem, "all"),
        run("equilibria", *FILES, "--method", "all"),
    )

    def untimed(text: str) -> list[list[str]]:
        return [[word for word in line.split() if "." not in word] for line in text.splitlines()]

    assert "homotopy" in str(result)
    assert len(untimed(str(result))) == len(untimed(printed))


def test_a_verdict_prints_as_the_command_verify(registration, tmp_path):
    path = tmp_path / "certificate.json"
    registration.certificate.save(path)
    forged = path.with_name("forged.json")
    forged.write_bytes(path.read_bytes().replace(b'"n": 4', b'"n": 5'))

    for file in (path, forged):
        assert str(certreg.verify(file)) == run("verify", file)
    assert str(certreg.verify(registration.certificate)) == run("verify", path)
    assert certreg.verify(path.read_bytes()).proved


def test_every_command_that_prints_a_result_is_compared():
    printing = {"certify", "equilibria", "assess", "simulate", "verify"}
    files = {"report", "apply", "codegen", "derive", "reproduce", "batch", "demo", "info"}

    assert set(COMMANDS) == printing | files


# Files and pictures -------------------------------------------------------------------------------


@pytest.mark.slow
def test_save_writes_what_the_command_writes(registration, tmp_path):
    path = registration.save(tmp_path / "python")
    run("certify", *FILES, "--sigma", 1.0, "--out", tmp_path / "command")
    names = [{p.name for p in (tmp_path / who).iterdir()} for who in ("python", "command")]

    assert path == tmp_path / "python" / "certificate.json"
    assert names[0] == names[1] >= {"certificate.json", "result.json", "pose.txt", "report.html"}
    for name in ("pose.txt",):
        assert (tmp_path / "python" / name).read_bytes() == (
            tmp_path / "command" / name
        ).read_bytes()


def test_report_writes_one_page_and_refuses_where_there_is_no_certificate(
    registration, problem, tmp_path, monkeypatch
):
    from certreg.registration import linear

    page = registration.report(tmp_path / "page.html")
    assert page.read_bytes().startswith(b"<!doctype html>")

    monkeypatch.setattr(linear, "produce", lambda *_, **__: None)
    bare = certreg.certify(problem, relaxation=False, simulation=False)
    with pytest.raises(certreg.CertregError, match=r"other\.html: not written: there is no cert"):
        bare.report(tmp_path / "other.html")
    assert not (tmp_path / "other.html").exists()


def test_residuals_and_covariance_stand_on_the_result(registration):
    problem, pose = registration.problem, registration.pose
    expected = np.linalg.norm(problem.target - pose.apply(problem.source), axis=1)

    np.testing.assert_allclose(registration.residuals, expected, rtol=1e-12)
    assert registration.residuals.shape == (4,)
    assert np.asarray(registration.covariance).shape == (6, 6)
    assert np.array_equal(registration.covariance, registration.covariance.matrix)


@pytest.mark.slow
def test_plot_draws_into_axes_of_three_dimensions(registration, monkeypatch):
    mpl.use("agg")
    from matplotlib import pyplot as plt

    axes = registration.plot()
    assert axes.name == "3d"
    assert registration.plot(axes) is axes
    assert {one.get_label() for one in axes.collections} == {"target", "source at the pose"}
    with pytest.raises(ValueError, match="three dimensions"):
        registration.plot(plt.figure().add_subplot())
    plt.close("all")


def test_plot_without_matplotlib_is_one_line(registration, monkeypatch):
    for name in ("matplotlib", "matplotlib.pyplot"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(certreg.CertregError, match=r"certreg\[figures\]") as caught:
        registration.plot()
    assert "\n" not in str(caught.value)


# Cards --------------------------------------------------------------------------------------------


class Elements(HTMLParser):
    """Elements that are open, and all attributes."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.attributes: list[tuple[str, str | None]] = []
        self.tags: set[str] = set()
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)
        self.tags.add(tag)
        self.attributes += attrs

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.mark.parametrize(
    "name", ["Registration", "Assessment", "assess", "equilibria", "simulate", "verify"]
)
def test_a_card_is_whole_and_loads_nothing(name, made):
    card = Elements(made[name]._repr_html_())

    assert card.open == []
    assert card.tags <= {"div", "table", "tr", "th", "td", "svg", "g", "title", "line", "circle",
                         "polyline"}  # fmt: skip
    assert {key for key, _ in card.attributes} & {"src", "href", "onload", "onclick"} == set()
    assert "svg" in card.tags or name not in {"Registration", "simulate"}
    assert len(made[name]._repr_html_()) < 30_000


def test_a_card_says_what_the_first_line_says(made):
    for name in ("Registration", "Assessment", "assess"):
        first = str(made[name]).splitlines()[0]
        assert first in made[name]._repr_html_()


def test_a_card_says_how_sure_the_pose_is_or_why_it_does_not(registration):
    bare = certreg.RegistrationProblem([[0.0, 0, 0], [1, 0, 0]], [[0.0, 0, 0], [0, 1, 0]])
    loose = certreg.certify(bare, relaxation=False, simulation=False)
    problem = certreg.RegistrationProblem(registration.problem.source, registration.problem.target)
    sure = certreg.certify(problem, relaxation=False, simulation=False)
    told, card = dict(uncertainty_rows(sure)), sure._repr_html_()

    for name in ("centre ±", "rotation ±", "translation ±"):
        assert f">{name} 1σ</th>" in card
        assert f">{told[name].partition('  (')[0]}</td>" in card
    assert ">uncertainty</th>" in loose._repr_html_()
    assert ">not known: the optimum is not unique</td>" in loose._repr_html_()


def test_words_of_a_file_are_escaped_in_a_card():
    words = "<script>alert(1)</script>\x1b[2J"
    verdict = made_verdict(words)

    assert "<script>" not in verdict
    assert "&lt;script&gt;" in verdict
    assert "\x1b" not in verdict


def made_verdict(words: str) -> str:
    from certreg.certificate.checking import CertificateVerdict

    return CertificateVerdict(ruling=results.Ruling.REFUTED, words=words)._repr_html_()


@pytest.mark.one_in(4)
@pytest.mark.parametrize("scale", [1e-150, 1.0, 1e150])
@pytest.mark.parametrize("n", [1, 2, 1000])
def test_clouds_of_every_size_have_a_card(scale, n):
    points = scale * np.random.default_rng(n).normal(size=(n, 3))
    result = certreg.certify(
        certreg.RegistrationProblem(points, points), relaxation=False, simulation=False
    )
    card = Elements(result._repr_html_())

    assert "svg" in card.tags
    assert len(result._repr_html_()) < 60_000
    numbers = [float(v or 0) for k, v in card.attributes if k in {"cx", "cy", "x1", "y1", "x2"}]
    assert min(numbers) >= 0
    assert max(numbers) <= 240


def test_every_shape_is_of_a_result_that_is_shown_and_the_other_way_round(made):
    shown = {type(part) for value in made.values() for part in parts(value, 1)
             if isinstance(part, results.Shown)}  # fmt: skip
    shapes = {shape.of(): shape for shape in presenting.SHAPES}

    for kind in shown:
        assert issubclass(kind, tuple(shapes)), kind
    for base, shape in shapes.items():
        presented = issubclass(base, results.Presented)
        assert presented == (shape.words is not None) == (shape.document is not None)
        assert presented or base.__name__ == "CertificateVerdict"


def test_what_shows_a_result_is_there():
    for shape in presenting.SHAPES:
        for find in (shape.words, shape.document, shape.card):
            assert find is None or callable(find())


def test_a_doubt_about_the_equilibria_stands_on_their_card(made):
    found = made["equilibria"]
    doubted = replace(found, doubt="a path < was lost")._repr_html_()

    assert "Not proved: a path &lt; was lost" in doubted
    assert "Not proved" not in replace(found, doubt=None)._repr_html_()
