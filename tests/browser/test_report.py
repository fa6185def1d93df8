"""The report in a browser, without a network: what it shows is what certreg computed.

Part of `make test-browser`, without which no browser is started.
"""

from __future__ import annotations

import itertools
import os
import re
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from commands import checked
from strategies import ZOO, random_rotation

from browser.pages import PATIENCE
from certreg.certificate import envelope
from certreg.problem.problem import RegistrationProblem
from certreg.registration.certification import certify
from certreg.registration.examples import STORIES, tell
from certreg.report import viewer
from certreg.report.pages import html_page as page_of
from certreg.report.pages import report_on
from certreg.results import Absent

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from playwright.sync_api import BrowserContext, ConsoleMessage, Page

    from certreg.registration.result import Registration

REQUIRED = bool(os.environ.get("CERTREG_BROWSER"))
pytestmark = pytest.mark.skipif(not REQUIRED, reason="drives the report: make test-browser")

HOSTILE = [
    "</script><script>document.title='owned'</script>",
    "<img src=x onerror=\"document.title='owned'\">",
    "\"'`&amp;{{}}\\u003c",
    "\u202egnol " + "ä€𝄞" * 300,
    "--><!--<script>",
]
DRAWN = """() => {
  const view = document.getElementById('view');
  const copy = document.createElement('canvas');
  [copy.width, copy.height] = [view.width, view.height];
  const context = copy.getContext('2d');
  context.drawImage(view, 0, 0);
  const seen = context.getImageData(0, 0, copy.width, copy.height).data;
  let count = 0;
  for (let i = 3; i < seen.length; i += 4) count += seen[i] > 0;
  return count;
}"""
SIGHT = "() => document.getElementById('view').toDataURL()"


def problem_of(n: int) -> RegistrationProblem:
    rng = np.random.default_rng(n)
    source = rng.normal(size=(n, 3)) * [3.0, 2.0, 1.0]
    return RegistrationProblem(source, -source[:, [1, 0, 2]] + 0.01 * rng.normal(size=(n, 3)))


class Opened:
    """A report in a browser, and all that went wrong in it."""

    def __init__(self, context: BrowserContext, path: Path) -> None:
        self.faults = list[str]()
        self.page: Page = context.new_page()
        self.page.set_default_timeout(PATIENCE)
        self.page.on("console", self._heard)
        self.page.on("pageerror", lambda error: self.faults.append(str(error)))
        self.page.on("request", lambda request: self.faults.append(request.url))
        self.page.goto(path.as_uri())
        self.page.wait_for_selector("html[data-ready]", state="attached")
        assert self.faults.pop(0) == path.as_uri()

    def _heard(self, message: ConsoleMessage) -> None:
        if "GPU stall due to ReadPixels" not in message.text:  # rendering in software: what it is
            self.faults.append(message.text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.page, name)

    @property
    def rmse(self) -> float:
        """What the page says of the pose that it shows, from the points that it decoded."""
        words, measured = self.page.evaluate(  # both of one moment: the body may be moving
            "() => { const clock = document.getElementById('clock');"
            " return [clock.innerText, Number(clock.dataset.rmse)]; }"
        )
        told = float(words.split("RMSE ")[1])
        assert told == pytest.approx(measured, rel=1e-6, abs=1e-6)
        return measured

    def choose(self, index: int) -> None:
        self.page.click(f"button[data-component='{index}']")

    def sight(self) -> str:
        self.page.wait_for_timeout(60)  # one frame
        return self.page.evaluate(SIGHT)


@pytest.fixture(scope="module")
def survey() -> Registration:
    return tell(STORIES[0])


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Registration], Path]:
    folder = tmp_path_factory.mktemp("reports")

    def write(registration: Registration) -> Path:
        path = folder / f"{registration.problem.digest()[:12]}.html"
        path.write_bytes(page_of(report_on(registration)))
        return path

    return write


@pytest.fixture(scope="module")
def window(opened: Callable[..., BrowserContext]) -> Iterator[BrowserContext]:
    """For all reports without options: to open a tab in it takes half as long as another window."""
    context = opened()
    context.new_page()  # or the window would close with the last tab
    yield context
    context.close()


@pytest.fixture
def shown(
    opened: Callable[..., BrowserContext],
    window: BrowserContext,
    written: Callable[[Registration], Path],
) -> Iterator[Callable[..., Opened]]:
    used: list[Page | BrowserContext] = []

    def show(registration: Registration, **options: object) -> Opened:
        report = Opened(opened(**options) if options else window, written(registration))
        used.append(report.page.context if options else report.page)
        return report

    yield show
    for each in used:
        each.close()


def test_the_first_thing_said_is_the_verdict(shown, survey):
    report = shown(survey)

    assert report.inner_text("header .stamp") == "CERTIFIED"
    assert report.inner_text("h1") == "The global optimum, and unique, to within the proved bounds."
    assert "RMSE of 2395.550956 instead of 5.838987" in report.inner_text("#rests")
    assert report.faults == []


WHERE = """(names) => names.map((name) => {
  const { top, bottom, left, right } = document.querySelector(name).getBoundingClientRect();
  return [top, bottom, left, right];
})"""
FIRST = (".stamp", "h1", "#pose", "#copy", "#fit", "#histogram", "#view", "#legend", "#scale")


@pytest.mark.parametrize("kind", ["survey", "many", "mirrored"])
def test_verdict_pose_fit_and_scene_are_on_the_first_screen(shown, survey, kind):
    many = problem_of(2000)
    flipped = RegistrationProblem(many.source[:100], many.target[:100] * [1.0, 1.0, -1.0])
    registration = survey if kind == "survey" else certify(many, relaxation=False)
    if kind == "mirrored":
        registration = certify(flipped, relaxation=False)
    report = shown(registration, viewport={"width": 1366, "height": 768})

    for name, (top, bottom, left, right) in zip(FIRST, report.evaluate(WHERE, FIRST), strict=True):
        assert 0 <= top < bottom <= 768, name
        assert 0 <= left < right <= 1366, name
    assert ("1 warning, above" in report.inner_text("#fit")) == bool(registration.fit.warnings)
    assert report.faults == []


def test_the_pose_is_copied_with_all_its_digits(opened, written, survey):
    context = opened(permissions=["clipboard-read", "clipboard-write"])
    report = Opened(context, written(survey))
    report.click("#copy")
    report.locator("#copied", has_text="copied").wait_for()
    copied = report.evaluate("navigator.clipboard.readText()")
    rows = [[float(entry) for entry in row.split()] for row in copied.splitlines()]

    assert np.array_equal(rows, survey.pose.T_target_source)
    context.close()


RGB = re.compile(r"\d+")
BINS = """() => [...document.querySelectorAll('#histogram .bin')].map((bin) =>
  [Number(bin.textContent.split(' ')[0]), bin.getAttribute('fill'), bin.height.baseVal.value])"""


def test_the_histogram_counts_every_pair_in_the_colours_of_the_scene(shown):
    registration = certify(problem_of(200), relaxation=False)
    report = shown(registration)
    problem = registration.problem
    distances = np.linalg.norm(problem.target - registration.pose.apply(problem.source), axis=1)
    counts, fills, heights = zip(*report.evaluate(BINS), strict=True)

    assert list(counts) == np.histogram(distances, bins=24, range=(0, distances.max()))[0].tolist()
    assert len(set(fills)) == 24
    assert all(red < blue for red, _, blue in (map(int, RGB.findall(fill)) for fill in fills))
    assert all((height > 1.9) == (count > 0) for count, height in zip(counts, heights, strict=True))
    end = 6.0 * np.median(distances)
    assert float(report.inner_text("#most")) == pytest.approx(end, rel=1e-2)
    assert report.inner_text("#of-what").strip() == "= 6 × the median"
    report.choose(3)
    assert float(report.inner_text("#most")) > 10.0 * distances.max()
    assert not report.inner_text("#of-what")
    assert report.faults == []


def test_the_worst_pair_is_drawn_in_another_colour_than_the_best(shown):
    source = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 2, 0], [0, -2, 0], [0, 0, 3], [0, 0, -3]])
    target = source.copy()
    target[4] += [0.3, 0.0, 0.0]
    about = {"labels": list("abcdef")}
    registration = certify(RegistrationProblem(source, target), relaxation=False, about=about)
    report = shown(registration)
    distances = np.linalg.norm(target - registration.pose.apply(source), axis=1)
    report.wait_for_timeout(60)
    worst, best = (
        report.evaluate(COLOUR, report.evaluate(TAG, ["source", int(row)]))
        for row in (distances.argmax(), distances.argmin())
    )

    assert worst[0] > 1.5 * worst[2]  # red
    assert best[2] > 1.1 * best[0]  # between blue and violet: it is at 43 % of the worst


SCALE = """() => {
  const [rule, words] = document.getElementById('scale').children;
  return [rule.getBoundingClientRect().width, parseFloat(words.textContent)];
}"""


def test_the_bar_is_as_long_as_it_says(shown):
    """Two points across the line of sight, and the bar beside what is seen of their distance."""
    source = np.array([[10.0, 0, 0], [-10, 0, 0], [0, 0.2, 0], [0, 0, 0.1]])
    about = {"labels": list("abcd")}
    report = shown(certify(RegistrationProblem(source, source), relaxation=False, about=about))
    report.wait_for_timeout(60)
    pixels, length = report.evaluate(SCALE)
    a, b = (np.array(report.evaluate(TAG, ["target", row])) for row in (0, 1))

    assert length in {1.0, 2.0, 5.0}
    # The points are seen askew and one from nearer; cos 0.35 = 0.94, and the eye is 3 radii off.
    assert np.linalg.norm(a - b) / pixels * length == pytest.approx(20.0 * np.cos(0.35), rel=0.15)


def test_levels_that_would_collapse_stand_on_a_logarithmic_axis(shown, survey):
    report = shown(survey)
    assert "logarithmic" in report.inner_text("#energy")
    flat = certify(problem_of(30), relaxation=False)
    assert "logarithmic" not in shown(flat).inner_text("#energy")


def test_every_button_shows_its_pose_and_its_words(shown, survey):
    report = shown(survey)
    sights = set[str]()
    for index, component in enumerate(survey.equilibria.components):
        report.choose(index)
        growing = report.locator("#spectrum circle.growing").count()

        assert report.rmse == pytest.approx(component.rmse, rel=1e-6)
        assert f"RMSE {component.rmse:.6f}" in report.inner_text("#clock")
        assert ("No pose fits better" in report.inner_text("#caption")) == component.optimal
        assert report.is_visible("#push") == (not component.optimal)
        assert (growing > 0) == (not component.optimal)
        assert f"{index} of 12 eigenvalues" in report.inner_text("#spectrum")
        sights.add(report.sight())

    assert len(sights) == 4
    assert report.faults == []


DOTS = """() => [...document.querySelectorAll('#spectrum circle')].map((dot) =>
  [dot.cx.baseVal.value, dot.cy.baseVal.value, Number(dot.classList.contains('growing'))])"""


PLACES = """() => [...document.querySelectorAll('#spectrum text.count')].map((words) => {
  const { x, y } = words.getBoundingClientRect();
  return [x, y];
})"""


def blots(dots: list[list[float]]) -> int:
    """How many spots there are of dots with no room for two numbers, each of one colour."""
    left, count = [tuple(dot) for dot in dots], 0
    while left:
        count, reached = count + 1, [left.pop()]
        for x, y, kind in reached:
            near = [d for d in left if d[2] == kind and np.hypot(d[0] - x, d[1] - y) < 26.0]
            reached += near
            left = [d for d in left if d not in near]
    return count


def test_spots_in_the_plane_of_eigenvalues_count_up_to_twelve(shown, survey):
    for registration in (survey, tell(STORIES[2])):
        report = shown(registration)
        for index in range(4):
            report.choose(index)
            spots = blots(report.evaluate(DOTS))
            counts = report.locator("#spectrum text.count").all_text_contents()
            several = [int(words.removeprefix("×")) for words in counts]

            places = report.evaluate(PLACES)

            assert all(count > 1 for count in several)
            assert all(
                abs(a[0] - b[0]) > 20.0 or abs(a[1] - b[1]) > 10.0
                for a, b in itertools.combinations(places, 2)
            )
            assert sum(several) + spots - len(several) == 12


LEVELS = """() => {
  const box = (node) => node.getBoundingClientRect();
  const names = [...document.querySelectorAll('#energy .level-name')].map((node) => {
    const { top, bottom } = box(node);
    return [node.textContent, top, bottom];
  });
  return [names, [...document.querySelectorAll('#energy .level')].map((node) => box(node).top)];
}"""


@pytest.mark.parametrize("width", [320, 1280])
@pytest.mark.parametrize("story", range(3))
def test_every_level_of_energy_is_named_and_no_name_struck_through(shown, story, width):
    registration = tell(STORIES[story])
    report = shown(registration, viewport={"width": width, "height": 800})
    report.click("#released")
    names, levels = report.evaluate(LEVELS)
    told = [int(i) for words, *_ in names for i in re.findall(r"\d+", words)]
    pixels = [middle for _, top, bottom in names for middle in [(top + bottom) / 2.0]]

    assert len(told) == len(levels) > 0
    assert told == sorted(told, reverse=True)
    assert all(abs(level - middle) > 4.0 for level in levels for middle in pixels)
    assert all(b - a > 10.0 for a, b in itertools.pairwise(sorted(pixels)))


def test_the_lines_within_the_bodies_are_in_the_legend(shown, survey):
    assert "bodies" in shown(survey).inner_text("#legend")
    cloud = certify(problem_of(61), relaxation=False)  # drawn without such lines
    assert "bodies" not in shown(cloud).inner_text("#legend")


def test_the_canvas_is_not_blank_and_follows_the_page_into_the_dark(shown, survey):
    report = shown(survey)
    bright = report.sight()
    assert report.evaluate(DRAWN) > 300

    report.emulate_media(color_scheme="dark")
    assert report.sight() != bright
    assert report.faults == []


TAG = """([cloud, row]) => {
  const tag = document.querySelectorAll(`.tag.${cloud}`)[row];
  const { e, f } = new DOMMatrix(getComputedStyle(tag).transform);
  return [e, f];
}"""
COLOUR = """([x, y]) => {
  const view = document.getElementById('view');
  const copy = document.createElement('canvas');
  [copy.width, copy.height] = [view.width, view.height];
  const context = copy.getContext('2d');
  context.drawImage(view, 0, 0);
  const scale = view.width / view.clientWidth;
  return [...context.getImageData(Math.round(x * scale), Math.round(y * scale), 1, 1).data];
}"""


def test_the_body_is_drawn_where_the_pose_puts_it(shown):
    rng = np.random.default_rng(11)
    source = rng.normal(size=(5, 3))
    about = {"labels": list("abcde")}
    problem = RegistrationProblem(source, source @ random_rotation(rng).T + 2.0)
    report = shown(certify(problem, relaxation=False, about=about))

    def distances() -> list[float]:
        report.wait_for_timeout(60)  # one frame
        source, target = (
            np.array([report.evaluate(TAG, [cloud, row]) for row in range(5)])
            for cloud in ("source", "target")
        )
        return np.linalg.norm(source - target, axis=1).tolist()

    assert max(distances()) < 1.0  # of a pixel: without noise the clouds lie on one another
    report.choose(3)
    assert max(distances()) > 100.0
    drawn = [report.evaluate(COLOUR, report.evaluate(TAG, ["source", row])) for row in range(5)]
    coloured = [max(pixel[:3]) > 2 * min(pixel[:3]) for pixel in drawn]
    assert sum(coloured) >= 4  # a ring of the target may lie before one
    assert report.faults == []


BOXES = """() => {
  const all = (names) => [...document.querySelectorAll(names)];
  const boxes = (nodes) => nodes.map((node) => {
    const { left, right, top, bottom } = node.getBoundingClientRect();
    return [left, right, top, bottom];
  });
  const tags = all('.tag').filter((tag) => tag.style.visibility === 'visible');
  const marks = all('#histogram text').filter((one) => one.textContent.startsWith('RMSE'));
  const bins = all('#histogram .bin').filter((bin) => bin.height.baseVal.value > 0);
  const named = tags.map((tag) => tag.textContent);
  return { named, tags: boxes(tags), marks: boxes(marks), bins: boxes(bins) };
}"""


def meet(one: list[float], other: list[float]) -> bool:
    return (
        max(one[0], other[0]) < min(one[1], other[1]) - 0.5
        and max(one[2], other[2]) < min(one[3], other[3]) - 0.5
    )


def test_no_name_covers_another_and_the_mark_of_the_histogram_covers_no_bar(shown):
    rng = np.random.default_rng(5)
    source = rng.normal(size=(12, 3)) * [3.0, 2.0, 1.0]
    target = source[rng.permutation(12)] @ random_rotation(rng).T
    about = {"labels": [f"Point-{k}" for k in range(12)]}
    report = shown(certify(RegistrationProblem(source, target), about=about, relaxation=False))
    report.wait_for_timeout(60)  # one frame
    seen = report.evaluate(BOXES)
    worst = report.locator("#residuals li bdi").first.inner_text()

    assert len(seen["tags"]) > 12
    assert worst in seen["named"]
    assert not any(meet(a, b) for a, b in itertools.combinations(seen["tags"], 2))
    assert len(seen["marks"]) == 1
    assert not any(meet(seen["marks"][0], bar) for bar in seen["bins"])


def test_where_all_is_rounding_nothing_alarms_and_one_rmse_is_told(shown):
    line = np.linspace(0.0, 1.0, 12)[:, None] * [1.0, 2.0, 3.0]
    exact = certify(
        RegistrationProblem(line, line @ random_rotation(np.random.default_rng(3)).T),
        relaxation=False,
    )
    report = shown(exact)
    told = re.findall(r"RMSE\s+([\d.e-]+)", report.inner_text(".first"))

    assert exact.fit.rounded
    assert told == [f"{exact.rmse:.9e}"] * 2
    assert not report.is_visible("#ramp")
    assert report.inner_text("#level") == "distances: at rounding"
    assert report.locator("#histogram svg, #residuals li").count() == 0
    assert report.faults == []


def test_what_is_proved_ends_above_the_fold(shown):
    source = problem_of(60).source
    spoilt = source + 5.0 * np.isin(np.arange(60), (7, 21))[:, None]
    for target in (source, spoilt, source[::-1]):
        report = shown(
            certify(RegistrationProblem(source, target), relaxation=False),
            viewport={"width": 1366, "height": 768},
        )
        ((_, bottom, _, _),) = report.evaluate(WHERE, ["#proved"])
        assert bottom <= 768


def test_up_is_z_and_what_cannot_move_has_no_button_to_play_it(shown, survey):
    report = shown(survey)
    arms = report.locator("#axes text")
    heights = {
        arms.nth(k).inner_html(): float(str(arms.nth(k).get_attribute("y"))) for k in range(3)
    }
    line = np.outer([0.0, 1.0, 2.0, 5.0], [1.0, 2.0, 3.0])
    still = shown(certify(RegistrationProblem(line, line), relaxation=False))

    assert heights["z"] == min(heights.values()) < -20.0
    assert report.is_visible("#play")
    assert not report.is_visible("#still")
    assert still.inner_text("#still").startswith("Nothing moves here")
    assert not any(map(still.is_visible, ("#play", "#time")))


def test_play_moves_the_body_to_the_optimum_and_stops_there(shown, survey):
    report = shown(survey)
    report.click("#released")
    start, before = report.rmse, report.sight()
    report.wait_for_timeout(700)

    assert report.inner_text("#play") == "Pause"
    assert report.sight() != before
    assert report.rmse != start
    report.locator("#play", has_text="Play").wait_for()
    assert report.rmse == pytest.approx(survey.rmse, rel=0.01)
    assert report.faults == []


def test_a_pushed_saddle_is_left(shown, survey):
    report = shown(survey)
    report.choose(3)
    report.click("#push")
    report.click("#play")  # pause
    scrub(report, 1000)

    assert report.inner_text("#caption").startswith("Pushed off the worst rotation (index 3)")
    assert "It comes to rest at the optimum." in report.inner_text("#caption")
    assert report.rmse == pytest.approx(survey.rmse, rel=0.01)
    assert report.faults == []


def scrub(report: Any, value: float) -> None:
    report.evaluate(
        """(value) => {
          const slider = document.getElementById('time');
          slider.value = value;
          slider.dispatchEvent(new Event('input'));
        }""",
        value,
    )


def test_scrubbing_moves_the_charts_with_the_scene(shown, survey):
    report = shown(survey)
    seen = list[tuple[str, ...]]()
    for value in (0, 300, 900):
        scrub(report, value)
        cursor = report.locator("#energy line.cursor")
        seen.append(
            (str(cursor.get_attribute("x1")), *map(report.inner_text, ("#energy", "#residuals")))
        )
    energies = [float(re.findall(r"V, all of it: ([\d.e-]+)", words)[0]) for _, words, _ in seen]

    assert all(len(set(values)) == 3 for values in zip(*seen, strict=True))
    assert energies[0] > energies[1] > energies[2]
    trajectory, unit = survey.solution.trajectory, float(survey.solution.energy_unit)
    assert energies[0] == pytest.approx(unit * trajectory.potential[0], rel=1e-3)

    box = report.locator("#energy svg").bounding_box()
    report.mouse.click(box["x"] + 0.3 * box["width"], box["y"] + 0.5 * box["height"])
    assert re.match(r"t = \d", report.inner_text("#clock"))
    assert report.faults == []


def test_the_worst_pairs_come_first_under_their_labels(shown):
    head = tell(STORIES[1])
    report = shown(head)
    labels = checked(head.certificate).about["labels"]
    distances = np.linalg.norm(head.problem.target - head.pose.apply(head.problem.source), axis=1)
    worst = np.argsort(-distances)[:8]

    assert report.locator("#residuals bdi").all_inner_texts() == [labels[row] for row in worst]
    told = [float(words) for words in report.locator("#residuals .value").all_inner_texts()]
    assert told == pytest.approx(distances[worst], rel=1e-4)
    assert report.faults == []


def test_the_certificate_is_saved_byte_by_byte(shown, survey, tmp_path):
    report = shown(survey)
    with report.expect_download() as waiting:
        report.click("#save")
    waiting.value.save_as(tmp_path / "certificate.json")

    assert waiting.value.suggested_filename == "certificate.json"
    assert (tmp_path / "certificate.json").read_bytes() == survey.certificate.to_json()


def test_all_can_be_done_with_the_keyboard(shown, survey):
    report = shown(survey)
    report.focus("#view")
    sights = [report.sight()]
    for key in ("ArrowLeft", "ArrowUp", "+", "Home"):
        report.keyboard.press(key)
        sights.append(report.sight())
    assert len(set(sights)) == 4
    assert sights[0] == sights[-1]

    report.keyboard.press("Space")
    assert report.inner_text("#play") == "Pause"
    report.focus("button[data-component='2']")
    report.keyboard.press("Enter")
    assert report.get_attribute("button[data-component='2']", "aria-pressed") == "true"
    assert report.inner_text("#play") == "Play"
    report.focus("#time")
    report.keyboard.press("End")
    assert report.rmse == pytest.approx(survey.rmse, rel=0.01)
    assert report.faults == []


def test_everything_that_can_be_pressed_has_a_name(shown, survey):
    report = shown(survey)
    nameless = report.evaluate(
        """() => [...document.querySelectorAll('button, input, canvas, svg')].filter((node) =>
          !(node.closest('[aria-hidden]') || node.textContent.trim() || node.ariaLabel
            || node.labels?.length)).length"""
    )

    assert nameless == 0


@pytest.mark.parametrize("specimen", ZOO, ids=lambda specimen: specimen.name)
def test_degenerate_data_are_shown_as_what_they_are(shown, specimen):
    registration = certify(specimen.problem, relaxation=False)
    report = shown(registration)
    unique = registration.equilibria.classification.unique
    components = registration.equilibria.components

    poor = bool(registration.fit.warnings)
    assert poor == (specimen.name.startswith("mirrored") or "cancelling" in specimen.name)
    stamp = "CERTIFIED OPTIMUM, BUT THE FIT IS POOR" if poor else "CERTIFIED"
    assert report.inner_text(".stamp") == (stamp if unique else "CERTIFIED, BUT NOT UNIQUE")
    assert report.locator("button.rest").count() == len(components)
    for index, component in enumerate(components):
        report.choose(index)
        sliders = report.locator("#along input")
        assert sliders.count() == component.kind.dimension
        for k in range(sliders.count()):
            sliders.nth(k).fill("57.5")
            assert report.rmse == pytest.approx(component.rmse, rel=1e-6, abs=1e-9)
    assert report.is_visible("#released") == (
        not isinstance(registration.solution.trajectory, Absent)
    )
    assert report.evaluate(DRAWN) > 10
    assert report.faults == []


def test_moving_along_a_circle_moves_the_body(shown):
    registration = certify(
        next(s for s in ZOO if s.name == "mirrored tall").problem, relaxation=False
    )
    report = shown(registration)
    sights = {report.sight()}
    for angle in ("23", "57", "91"):
        report.fill("#along input", angle)
        sights.add(report.sight())
        assert report.rmse == pytest.approx(registration.rmse)

    assert len(sights) == 4


@pytest.mark.parametrize("n", [1, 2, 3])
def test_few_points_are_enough(shown, n):
    registration = certify(problem_of(n), relaxation=False)
    report = shown(registration)

    assert report.rmse == pytest.approx(registration.rmse, rel=1e-6, abs=1e-9)
    assert report.faults == []


@pytest.mark.parametrize("exponent", [-150, 0, 150])
def test_any_scale_can_be_shown(shown, exponent):
    problem = problem_of(30)
    scale = 10.0**exponent
    registration = certify(
        RegistrationProblem(problem.source * scale, problem.target * scale), relaxation=False
    )
    report = shown(registration)
    report.choose(3)

    assert report.rmse == pytest.approx(registration.equilibria.components[3].rmse, rel=1e-6)
    assert report.evaluate(DRAWN) > 300
    assert report.faults == []


def test_hostile_labels_are_only_text(shown):
    problem = problem_of(len(HOSTILE))
    about = {"source": HOSTILE[0], "target": HOSTILE[1], "labels": HOSTILE}
    report = shown(certify(problem, relaxation=False, about=about))
    texts = report.locator("#residuals bdi").all_inner_texts()

    assert sorted(texts) != []
    assert HOSTILE[0] in texts
    assert HOSTILE[0] in report.inner_text(".files")
    assert any("\\u202e" in words for words in texts)
    assert "owned" not in report.title().replace(HOSTILE[0], "").replace(HOSTILE[1], "")
    assert report.locator("img").count() == 0
    assert report.evaluate("document.documentElement.scrollWidth") <= 1280
    assert report.faults == []


def test_on_a_phone_matrices_scroll_and_do_not_wrap(shown, survey):
    report = shown(survey, viewport={"width": 390, "height": 844})
    lines = report.evaluate(
        """() => [...document.querySelectorAll('#pose pre, #matrix')].map((place) => [
          place.clientHeight / parseFloat(getComputedStyle(place).lineHeight),
          place.scrollWidth > place.clientWidth, getComputedStyle(place).overflowX])"""
    )

    assert [4 <= count < 5.2 for count, _, _ in lines] == [True, True]
    assert lines[1][1:] == [True, "auto"]


@pytest.mark.parametrize("width", [320, 390])
def test_a_phone_shows_all_of_it(shown, survey, width):
    report = shown(survey, viewport={"width": width, "height": 800})
    for index in range(4):
        report.choose(index)
        assert report.evaluate("document.documentElement.scrollWidth") == width
    assert report.faults == []


CUT = """() => [...document.querySelectorAll('figure svg text')].filter((text) => {
  const [inner, outer] = [text, text.ownerSVGElement].map((one) => one.getBoundingClientRect());
  return inner.left < outer.left - 1 || inner.right > outer.right + 1 || inner.top < outer.top - 1;
}).map((text) => text.textContent)"""


def test_no_word_of_a_chart_is_cut_on_a_phone(shown, survey):
    report = shown(survey, viewport={"width": 390, "height": 844})

    assert report.evaluate(CUT) == []


def test_without_webgl_all_else_works(opened, written, survey):
    context = opened()
    context.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    report = Opened(context, written(survey))
    report.choose(3)

    assert "no WebGL" in report.inner_text("#view-note")
    assert report.rmse == pytest.approx(2395.550956, rel=1e-6)
    scrub(report, 500)
    assert "V, all of it: " in report.inner_text("#energy")
    context.close()


def test_without_javascript_the_proof_can_be_read(opened, written, survey):
    context = opened(java_script_enabled=False)
    page = context.new_page()
    page.goto(written(survey).as_uri())

    assert "unique" in page.inner_text("h1")
    assert "exactly four equilibria" in page.inner_text("#proof")
    assert "The pictures need JavaScript" in page.inner_text("noscript")
    context.close()


def test_it_prints_on_a_few_pages_with_its_scene(shown, survey):
    report = shown(survey)
    pages = len(re.findall(rb"/Type\s*/Page\b", report.pdf(format="A4")))

    assert 1 < pages <= 5


def test_it_prints_in_bright_colours_whatever_the_screen_has(shown, survey):
    dark, bright = shown(survey, color_scheme="dark"), shown(survey)
    for report in (dark, bright):
        report.emulate_media(media="print")
    for _ in range(50):  # until both have drawn at the size of the paper
        if dark.sight() == bright.sight():
            break

    assert dark.sight() == bright.sight()


def test_the_network_is_forbidden_to_the_page(shown, survey):
    report = shown(survey)
    failed = report.evaluate(
        """async () => {
          const image = new Image();
          image.src = 'file:///etc/passwd';
          const script = document.createElement('script');
          script.textContent = 'window.owned = 1';
          document.body.append(script);
          try { await fetch('https://nowhere.invalid'); } catch { return window.owned ?? 'none'; }
        }"""
    )

    assert failed == "none"
    assert sum("Content Security Policy" in fault for fault in report.faults) >= 2


def test_ten_thousand_points_fit_into_a_small_file_and_move(shown, written):
    registration = certify(problem_of(10_000), relaxation=False)
    path = written(registration)
    report = shown(registration)
    assert path.stat().st_size <= 1_500_000
    assert "295 of 10000 springs are drawn" in report.inner_text("#view-note")
    report.choose(1)

    rmse = registration.equilibria.components[1].rmse
    assert report.rmse == pytest.approx(rmse, rel=1e-6)
    scrub(report, 500)
    assert report.faults == []


def test_points_that_the_certificate_does_not_hold_are_shown_as_a_sample(
    shown, written, monkeypatch
):
    monkeypatch.setattr(envelope.CertificateBody, "INLINE", 100)
    monkeypatch.setattr(viewer, "SAMPLE", 50)
    registration = certify(problem_of(101), relaxation=False)
    report = shown(registration)

    assert "does not hold all 101 points: an even sample is shown" in report.inner_text(
        "#view-note"
    )
    assert report.rmse == pytest.approx(registration.rmse, rel=0.5)
    assert report.faults == []


def test_a_certificate_too_large_for_its_page_is_left_out_of_it(shown, monkeypatch):
    monkeypatch.setattr("certreg.report.any_report.EMBEDDED_BYTES", 9)
    problem = problem_of(40)
    registration = certify(problem, relaxation=False)
    report = shown(registration)

    assert report.locator("#save").count() == 0
    assert "too large for a page" in report.inner_text("#check")
    assert "sample's RMSE" in report.inner_text("#clock")
    assert report.rmse == pytest.approx(registration.rmse, rel=1e-6)
    assert report.faults == []


MODELS = {
    "asymmetric": {"scale": "asymmetric"},
    "symmetric": {"scale": "symmetric"},
    "rotation": {"rotation_only": True},
    "both": {"scale": "asymmetric", "rotation_only": True},
}


@pytest.mark.parametrize("model", list(MODELS))
@pytest.mark.parametrize(("width", "colours"), [(320, "light"), (1280, "dark")])
def test_the_page_of_a_scale_or_no_translation_opens_without_a_fault(
    opened, written, model, width, colours
):
    whole = problem_of(12)
    problem = RegistrationProblem(whole.source, 2.5 * whole.target, **MODELS[model])
    context = opened(viewport={"width": width, "height": 800}, color_scheme=colours)
    page, faults = context.new_page(), list[str]()
    page.on("console", lambda message: faults.append(message.text))
    page.goto(written(certify(problem)).as_uri())

    assert page.inner_text(".stamp").startswith("CERTIFIED")
    assert page.evaluate("document.documentElement.scrollWidth") == width
    assert page.locator("svg").count() == {"rotation": 2, "symmetric": 1}.get(model, 3)
    assert faults == []
    context.close()
