// What is shown: a run at a time, or an equilibrium. Everything that draws is told of each change.

import { member } from "./rotation.js";

const SECONDS = 7; // of a run as it is played

/** What is shown, and how it changes. */
export class Player {
  constructor(components, runs) {
    this.components = components;
    this.runs = runs;
    this.rest = 0; // the equilibrium that was chosen last
    this.angles = [];
    this.run = null; // the run that is shown, or null
    this.time = 0;
    this.playing = false;
    this.listeners = [];
  }

  /** Calls a listener after each change; `moved` if nothing but the time has changed. */
  listen(listener) {
    this.listeners.push(listener);
  }

  /** Pose now: quaternion and offset of the centroids. */
  get pose() {
    if (this.run) return this.run.at(this.time);
    const { basis, dimension, quaternion } = this.components[this.rest];
    const member_ = dimension && this.angles.length ? member(basis, this.angles) : quaternion;
    return { quaternion: member_, offset: [0, 0, 0] };
  }

  /** Shows an equilibrium; of one that is no single pose, the member at these angles. */
  choose(rest, angles = []) {
    Object.assign(this, { rest, angles, run: null, playing: false });
    this.#tell(false);
  }

  /** Shows a run from its start. */
  begin(run, { play }) {
    Object.assign(this, { run, time: 0, rest: run.start ?? 0, angles: [] });
    this.playing = false;
    this.#tell(false);
    if (play) this.play();
  }

  /** Shows the run, or the first, at a time. */
  scrub(time) {
    const changed = !this.run;
    if (changed) this.#first();
    this.playing = false;
    this.time = Math.min(this.run.end, Math.max(0, time));
    this.#tell(!changed);
  }

  /** Plays or pauses; at its end a run begins anew. */
  toggle() {
    if (this.playing) {
      this.playing = false;
      this.#tell(false);
      return;
    }
    if (!this.run) this.#first();
    if (this.time >= this.run.end) this.time = 0;
    this.play();
  }

  play() {
    this.playing = true;
    this.#tell(false);
    let before = null;
    const step = (now) => {
      if (!this.playing) return;
      this.time = Math.min(this.run.end, this.time + ((now - (before ?? now)) / 1000 / SECONDS) * this.run.end);
      before = now;
      this.playing = this.time < this.run.end;
      this.#tell(this.playing);
      if (this.playing) requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  #first() {
    Object.assign(this, { run: this.runs[0], time: 0, rest: this.runs[0].start ?? 0, angles: [] });
  }

  #tell(moved) {
    for (const listener of this.listeners) listener(moved);
  }
}
