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
import { figure } from "./svg.js";
import { Tags } from "./tags.js";

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

function clock({ run, time }, rmse, sampled) {
  part("time").value = run ? (1000 * time) / (run.end || 1) : 0;
  const words = run ? `t = ${time.toFixed(2)} · ` : "";
  part("clock").textContent = `${words}${sampled ? "sample's " : ""}RMSE ${figure(rmse, 7)}`;
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

/** How high the words above the scene are, so that the scene ends where the screen does. */
function fitted() {
  const { style } = document.documentElement;
  const told = () => style.setProperty("--head", `${part("see").offsetTop}px`);
  told();
  new ResizeObserver(told).observe(document.querySelector("header"));
}

async function main() {
  copying();
  fitted();
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
  const rulers = stage && new Rulers(clouds.length);
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
    if (!player.run) most = clouds.largest;
    stage?.tint(most);
    part("most").textContent = figure(most, 3);
    clock(player, rmse, sampled);
    drawHistogram(chart("histogram"), clouds, { rmse, most });
    drawResiduals(chart("residuals"), clouds, { labels: scene.labels, rmse, sampled });
  };
  player.listen(show);
  wire(player, scene);
  legend(stage, clouds, scene, sampled);
  show(false);
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

function legend(stage, clouds, scene, sampled) {
  const entries = [[stage?.frames.length === 0 ? "target many" : "target", "target"], ["source", "source, moved"], ["thread", "springs"]];
  if (stage?.frames.length) entries.push(["frame", "bodies, from their centres"]);
  const made = entries.map(([kind, words]) => {
    const entry = document.createElement("span");
    entry.className = `entry ${kind}`;
    entry.textContent = words;
    return entry;
  });
  const scale = document.createElement("span");
  scale.className = "ramp";
  const [bar, most] = [document.createElement("i"), document.createElement("output")];
  most.id = "most";
  scale.append("distance of a pair: 0", bar, most);
  part("legend").append(...made.slice(0, 2), scale, ...made.slice(2));
  const words = [];
  if (sampled) words.push(`This page does not hold all ${scene.n} points: an even sample is shown.`);
  if (stage && stage.rows.length < clouds.n) words.push(`${stage.rows.length} of ${scene.n} points are drawn.`);
  if (stage && stage.ends.length < clouds.n) {
    words.push(`${stage.ends.length} of ${clouds.n} springs are drawn; all of them count.`);
  }
  if (words.length) part("view-note").textContent = words.join(" ");
}

main();
