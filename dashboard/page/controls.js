// The buttons. A button says what was asked; only the robots' own status says that it was done.

import {get, wish} from "./api.js";
import {confirmButton, el, find, setText} from "./dom.js";
import {list, timeOfDay} from "./format.js";

const STOP_PATIENCE_MS = 1500;

const words = (wished) => String(wished ?? "").replaceAll("_", " ");

export class Controls {
  control = false;
  stopText = "";
  #stream;
  #why = "asking the server";
  #stop = null;  // topic
  #since = 0;    // [ms] when the stop began, as far as this page knows
  #asked = "";   // what was asked of the server and is not yet told back
  #failure = "";

  constructor(stream) {
    this.#stream = stream;
    find("stop").addEventListener("click", () => this.stop("button on the page"));
    confirmButton(
        find("release-place"), "release the stop …", "Robots will move again.", "release",
        () => this.#wish("release_stop"));
    confirmButton(
        find("end-place"), "end the run …", "The run ends now, its data are kept.", "end the run",
        () => this.#wish("end", {why: "from the page"}));
    const pause = el("button", {type: "button", id: "pause", text: "pause the script"});
    pause.addEventListener("click", () => this.#wish(this.#paused() ? "resume" : "pause"));
    find("pause-place").append(pause);
    this.#form("mark-form", async () => {
      const text = find("mark-text").value.trim();
      if (text && await this.#wish("mark", {text})) find("mark-text").value = "";
    });
    const level = find("light-level");
    level.addEventListener("input", () => {
      find("light-value").value = `${level.value} %`;
    });
    this.#form(
        "light-form",
        () => this.#wish(
            "light",
            {intensity: Number(level.value) / 100, hold_s: Number(find("light-hold").value)}));
    find("light-release").addEventListener("click", () => this.#wish("release_light"));
    stream.on("stop", (stop) => this.#takeStop(stop));
    stream.on(
        "note", (note) => this.#say(`${timeOfDay(note.t_us)} ${words(note.wish)}: ${note.text}`));
    stream.on(
        "script", () => setText(pause, this.#paused() ? "resume the script" : "pause the script"));
    stream.on("lab", () => this.#enable());
    let asked = -1;
    stream.on("pulse", () => {
      if (asked === stream.attempts) return;
      asked = stream.attempts;
      this.#askMe();
    });
    addEventListener("hashchange", () => this.#askMe());
    setInterval(() => this.#showStop(), 100);
  }

  /** Emergency stop. The robots' status tells what came of it (topic `stop`). */
  async stop(reason) {
    if (!this.control) {
      this.#failure = `This page cannot stop the robots: ${
          this.#why}. Use the robots' own switches, or lab stop in a terminal.`;
      this.#showStop();
      return;
    }
    this.#asked = "stop asked for, waiting for the robots";
    this.#failure = "";
    if (this.#stop?.state !== "stopping") this.#since = performance.now();
    this.#showStop();
    const {ok, error} = await wish("stop", {reason}, STOP_PATIENCE_MS);
    if (!ok)
      this.#failure =
          `STOP NOT SENT: ${error}. Use the robots' own switches, or lab stop in a terminal.`;
    if (!ok || this.#stop?.state === "stopped")
      this.#asked = "";  // stopped already: there is no news to wait for
    this.#showStop();
  }

  async #wish(name, fields = {}) {
    this.#say(`${words(name)} asked for`);
    const {ok, error} = await wish(name, fields);
    if (!ok) this.#say(`${words(name)}: ${error}`, "bad");
    return ok;
  }

  #say(text, kind = "quiet") {
    setText(find("note"), text, kind);
  }

  #form(id, act) {
    find(id).addEventListener("submit", (event) => {
      event.preventDefault();
      act();
    });
  }

  #paused = () => this.#stream.topics.get("script")?.phase === "paused";

  async #askMe() {
    const me = await get("/api/me");
    this.control = me?.control === true;
    this.#why = me?.why || (me ? "the server does not say why" : "the server does not answer");
    this.#failure = "";
    this.#enable();
  }

  #enable() {
    const replay = this.#stream.topics.get("lab")?.replay === true;
    find("read-only").hidden = this.control && !replay;
    setText(
        find("read-only"),
        replay ? "A recorded run: no robot listens. The slider below the arena plays it." :
                 `Read-only: ${this.#why}.`,
        "warn");
    for (const button of find("controls").querySelectorAll("button, input, select"))
      button.disabled = !this.control || replay;
    find("stop").disabled = !this.control || replay;
    document.body.dataset.control = String(this.control);
    this.#showStop();
  }

  #takeStop(stop) {
    if (stop.state === "stopping" && this.#stop?.state !== "stopping" && !this.#asked)
      this.#since = performance.now();
    if (stop.state !== "free") this.#asked = "";
    if (stop.state !== this.#stop?.state) this.#failure = "";
    this.#stop = stop;
    this.#showStop();
  }

  #showStop() {
    const stop = this.#stop;
    const late = performance.now() - this.#since > 1000;
    const missing = stop?.unconfirmed ?? [];
    let text = "no robot has been heard yet";
    let alarm = this.#failure;
    if (this.#stream.topics.get("lab")?.replay)
      text = "a recorded run: nobody obeys";
    else if (this.#asked) {
      text = this.#asked;
      if (late && !alarm)
        alarm =
            "No word from the robots yet. Use the robots' own switches, or lab stop in a terminal.";
    } else if (stop) {
      text = stopWords(stop);
      if (late && !alarm && missing.length &&
          (stop.state === "stopping" || stop.state === "stopped")) {
        alarm = `NOT confirmed: ${list(missing)}`;
      }
    }
    this.stopText = text;
    setText(find("stop-state"), text);
    setText(find("stop-missing"), alarm);
    find("bar").dataset.stop = this.#asked ? "stopping" : stop?.state ?? "";
    find("release-place").hidden = !stop || stop.state === "free";
  }
}

function stopWords(stop) {
  const by = stop.by ? `, by ${stop.by}` : "";
  const took = typeof stop.took_ms === "number" ? `, ${Math.round(stop.took_ms)} ms` : "";
  const robots = stop.total === 1 ? "the robot" : `all ${stop.total} robots`;
  if (stop.state === "free")
    return stop.total ? `${stop.total === 1 ? "the robot is" : robots + " are"} free to move` :
                        "no robot has been heard yet";
  if (stop.state === "stopping")
    return `stopping: ${stop.confirmed} of ${stop.total} confirmed${by}`;
  if (stop.state === "stopped") return `stopped: ${robots}${took}${by}`;
  if (stop.state === "releasing") return `releasing: ${stop.confirmed} of ${stop.total} confirmed`;
  return String(stop.state);
}
