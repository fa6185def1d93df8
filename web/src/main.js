// The report's page: what was written into it is drawn, and follows the controls.

import { drawMargin, drawResiduals, drawSpectrum, note } from "./charts.js";
import { Clouds } from "./clouds.js";
import { certificateBytes, pointBytes, sceneDocument } from "./contents.js";
import { copying } from "./copying.js";
import { EnergyChart } from "./energy.js";
import { drawHistogram } from "./histogram.js";
import { Orbit } from "./orbit.js";
import { Player } from "./player.js";
import { matrix } from "./rotation.js";
import { Rulers } from "./rulers.js";
import { Run } from "./runs.js";
import { Stage } from "./stage.js";
import { figure, path, svg } from "./svg.js";
import { Tags } from "./tags.js";

const SAME = 1e-5; // of an RMSE
const DECIMALS = 1e-6; // of an RMSE that is told without an exponent
const AT_ROUNDING = "All distances are at the rounding of the numbers";
const EDGE = 10; // pixels between what is proved and the end of the screen
const MANY = 20_000; // pairs, whose distances are measured in every fourth frame only

const part = (id) => document.getElementById(id);
const chart = (id) => part(id).querySelector(".chart");

/** The scene, or null where the browser has no WebGL; then the page says so. */
function openStage(clouds, axes, redraw) {
  try {
    const orbit = new Orbit(part("view"), axes, redraw);
    const stage = new Stage(part("view"), clouds, orbit);
    const keys = ["+", "-", "Home"];
    [...part("zoom").children].forEach((button, i) => {
      button.addEventListener("click", () => orbit.press(keys[i]));
    });
    return stage;
  } catch {
    part("view").hidden = true;
    part("view-note").textContent =
      "This browser has no WebGL, which the scene needs. All else on this page works.";
    return null;
  }
}

/** Sliders along the component that was chosen, if it is more than one pose. */
function sliders(player, component) {
  const place = part("along");
  if (place.dataset.component === String(player.rest)) return;
  place.dataset.component = player.rest;
  const inputs = Array.from({ length: component.dimension }, (_, k) => {
    const input = document.createElement("input");
    Object.assign(input, { type: "range", min: 0, max: 180, step: 0.5, value: 0 });
    input.setAttribute("aria-label", `Move along, ${k + 1} of ${component.dimension}`);
    input.addEventListener("input", () => {
      player.choose(player.rest, inputs.map((one) => (Number(one.value) * Math.PI) / 180));
    });
    return input;
  });
  const words = document.createElement("p");
  words.className = "note";
  words.textContent = "Move along these poses:";
  place.replaceChildren(...(inputs.length ? [words, ...inputs] : []));
}

function wire(player, scene) {
  part("play").addEventListener("click", () => player.toggle());
  part("time").addEventListener("input", (event) => {
    player.scrub((Number(event.target.value) / 1000) * (player.run ?? player.runs[0]).end);
  });
  part("released").addEventListener("click", () => {
    player.begin(player.runs.find((run) => run.start === null), { play: true });
  });
  part("push").addEventListener("click", () => {
    player.begin(player.runs.find((run) => run.start === player.rest), { play: true });
  });
  for (const button of document.querySelectorAll("[data-component]:is(button)")) {
    button.addEventListener("click", () => player.choose(Number(button.dataset.component)));
  }
  part("view").addEventListener("keydown", (event) => {
    if (event.key !== " " || !player.runs.length) return;
    event.preventDefault();
    player.toggle();
  });
  part("still").textContent = scene.still;
  part("still").hidden = Boolean(player.runs.length);
  part("play").hidden = part("time").hidden = !player.runs.length;
  part("released").hidden = !player.runs.some((run) => run.start === null);
}

/** Buttons, slider and words as they belong to what is shown. */
function mark(player) {
  const { run, rest } = player;
  part("play").textContent = player.playing ? "Pause" : "Play";
  part("released").setAttribute("aria-pressed", String(Boolean(run) && run.start === null));
  for (const button of document.querySelectorAll("[data-component]:is(button)")) {
    const chosen = !run && Number(button.dataset.component) === rest;
    button.setAttribute("aria-pressed", String(chosen));
  }
  const component = player.components[rest];
  sliders(player, component);
  part("push").hidden = Boolean(run) || !player.runs.some((one) => one.start === rest);
  part("caption").textContent = run ? motionWords(player) : component.words;
}

function motionWords({ run, components }) {
  const end = run.ended;
  if (run.start === null) return `The source moves as a rigid body, drawn by the springs. ${end}`;
  const { name, index } = components[run.start];
  return `Pushed off the ${name.toLowerCase()} (index ${index}) by a turn of 1°. ${end}`;
}

function clock({ run, time }, fit, sampled) {
  part("time").value = run ? (1000 * time) / (run.end || 1) : 0;
  const words = run ? `t = ${time.toFixed(2)} · ` : "";
  part("clock").textContent = `${words}${sampled ? "sample's " : ""}RMSE ${fit}`;
}

/** The RMSE in words: as the page says it elsewhere, where the pose is that one; else as measured. */
function fitWords({ run, rest, components }, rmse, { rounded, sampled }) {
  const { optimal, rmse: told } = components[rest];
  const near = Math.abs(rmse - Number(told)) <= Math.max(SAME * rmse, told.includes("e") ? 0 : DECIMALS) || (rounded && optimal);
  return !run && !sampled && near ? told : figure(rmse, 7);
}

function saving(bytes) {
  part("save").addEventListener("click", () => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([bytes], { type: "application/json" }));
    link.download = "certificate.json";
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
    part("saved").textContent = ` ${bytes.length.toLocaleString("en")} bytes, as certreg wrote them.`;
  });
}

/** How high what stands above and below the scene is, so that the screen ends where they do. */
function fitted() {
  const { style } = document.documentElement;
  const told = () => {
    const [scene, below] = ["view", "proved"].map((id) => part(id).getBoundingClientRect());
    style.setProperty("--head", `${part("see").offsetTop}px`);
    style.setProperty("--foot", `${Math.ceil(below.bottom - scene.bottom) + EDGE}px`);
  };
  told();
  new ResizeObserver(told).observe(document.querySelector("header"));
}

async function main() {
  copying();
  const scene = sceneDocument();
  const certificate = await certificateBytes();
  if (certificate) saving(certificate);
  const { bytes, sampled } = pointBytes(certificate);
  const clouds = new Clouds(bytes);
  const runs = scene.runs.map((fields) => new Run(fields, clouds.length));
  const player = new Player(scene.components, runs);
  let wanted = false;
  const redraw = () => {
    if (wanted) return;
    wanted = true;
    requestAnimationFrame(() => {
      wanted = false;
      stage?.draw();
      rulers?.draw(stage);
      tags?.draw();
      document.documentElement.dataset.ready ??= String(Math.round(performance.now()));
    });
  };
  const stage = openStage(clouds, scene.axes, redraw);
  const rulers = stage && new Rulers(clouds.length, scene.unit);
  stage?.hold(scene.components.map((component) => component.quaternion));
  const tags = stage && new Tags(stage, clouds, sampled ? [] : scene.named);
  const energy = energyChart(player, scene);
  let frames = 0;
  let most = 0; // the distance at the end of the colours: the largest of a pose, or as a run begins
  let begun = null; // the run to which it belongs
  const show = (moved) => {
    const { quaternion, offset } = player.pose;
    stage?.show(quaternion, offset);
    redraw();
    if (!moved) {
      mark(player);
      drawSpectrum(chart("spectrum"), scene.components[player.rest]);
      energy?.draw(player.run ?? runs[0]);
    }
    energy?.follow(player.run ? player.time : null);
    frames += 1;
    if (moved && clouds.n > MANY && frames % 4) return;
    if (player.run && player.run !== begun) {
      const start = player.run.at(0);
      clouds.measure(matrix(start.quaternion), start.offset);
      most = clouds.largest;
    }
    begun = player.run;
    const rmse = clouds.measure(matrix(quaternion), offset);
    const best = !player.run && scene.components[player.rest].optimal;
    if (!player.run) most = (best && scene.colours.end) || clouds.largest;
    const rounded = best && scene.rounded;
    stage?.tint(rounded ? 0 : most);
    rampWords(best ? scene.colours : null, { most, rounded, largest: clouds.largest });
    const fit = fitWords(player, rmse, { rounded, sampled });
    part("clock").dataset.rmse = rmse;
    clock(player, fit, sampled);
    if (rounded) {
      note(chart("histogram"), `${AT_ROUNDING}: no histogram is drawn of them.`);
      note(chart("residuals"), `${AT_ROUNDING}: which is the largest says nothing.`);
      return;
    }
    drawHistogram(chart("histogram"), clouds, { rmse, fit, most });
    drawResiduals(chart("residuals"), clouds, { labels: scene.labels, fit, sampled });
  };
  player.listen(show);
  wire(player, scene);
  legend(stage, clouds, scene, sampled);
  show(false);
  fitted();
  const resized = new ResizeObserver(() => {
    drawMargin(chart("margin"), scene.margin);
    show(false);
  });
  resized.observe(chart("margin"));
  if (stage) {
    new ResizeObserver(redraw).observe(part("view"));
    for (const media of ["(prefers-color-scheme: dark)", "print"]) {
      matchMedia(media).addEventListener("change", () => {
        stage.recolour();
        show(false);
        stage.draw(); // at once: a printer waits for no frame
      });
    }
  }
}

function energyChart(player, scene) {
  if (!player.runs.length) {
    note(chart("energy"), scene.still);
    return null;
  }
  return new EnergyChart(chart("energy"), {
    levels: scene.components,
    unit: scene.energy_unit ?? 1,
    scrub: (time) => player.scrub(time),
  });
}

/** What the end of the colours is; colours: those of the optimum, null at another pose. */
function rampWords(colours, { most, rounded, largest }) {
  const beyond = largest > most * (1 + 1e-9); // the largest itself is measured anew
  part("most").textContent = figure(most, 3);
  part("beyond").textContent = beyond ? "≥ " : "";
  part("of-what").textContent = colours ? ` = ${colours.words}` : "";
  part("ramp").hidden = rounded;
  part("level").hidden = !rounded;
}

const SPRING = [path([[9, 8], [20, 8]], {}), svg("circle", { cx: 5, cy: 8, r: 4, class: "ring" }), svg("circle", { cx: 23, cy: 8, r: 4, class: "dot" })];
const BODIES = ["of-target", "of-source"].map((kind, k) => {
  const [x, y] = [8 + 13 * k, 8];
  const arms = [[-5, 6], [-6, -3], [0, -7], [6, -2], [4, 6]];
  return svg("g", {}, ...arms.map(([a, b]) => path([[x, y], [x + a, y + b]], { class: kind })));
});

function legend(stage, clouds, scene, sampled) {
  const entries = [[stage?.frames.length === 0 ? "target many" : "target", "target"], ["source", "source, moved"], ["thread", "springs", SPRING]];
  if (stage?.frames.length) entries.push(["frame", "bodies", BODIES]);
  const made = entries.map(([kind, words, drawn]) => {
    const entry = document.createElement("span");
    entry.className = `entry ${kind}`;
    if (drawn) entry.append(svg("svg", { viewBox: "0 0 28 16", "aria-hidden": "true" }, ...drawn));
    entry.append(words);
    return entry;
  });
  const scale = document.createElement("span");
  Object.assign(scale, { className: "ramp", id: "ramp" });
  const [bar, beyond, most, what] = ["i", "span", "output", "span"].map((tag) => document.createElement(tag));
  const end = document.createElement("span");
  end.append(beyond, most, what);
  [beyond.id, most.id, what.id] = ["beyond", "most", "of-what"];
  scale.append("distance 0", bar, end);
  const level = document.createElement("span");
  Object.assign(level, { id: "level", hidden: true, textContent: "distances: at rounding" });
  part("legend").append(...made.slice(0, 2), scale, level, ...made.slice(2));
  const words = [];
  if (sampled) words.push(`This page does not hold all ${scene.n} points: an even sample is shown.`);
  if (stage && stage.rows.length < clouds.n) words.push(`${stage.rows.length} of ${scene.n} points are drawn.`);
  if (stage && stage.ends.length < clouds.n) {
    words.push(`${stage.ends.length} of ${clouds.n} springs are drawn; all of them count.`);
  }
  if (words.length) part("view-note").textContent = words.join(" ");
}

main();
