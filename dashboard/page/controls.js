// The buttons of the operator. A click only shows that the request was sent; its success is shown
// when the robots' status confirms it.

import {ask, sendRequest} from "./api.js";
import {confirmButton, el, find, setText} from "./dom.js";
import {list, timeOfDay} from "./format.js";

const STOP_TIMEOUT_MS = 1500;
const STOP_CROWDED_MS = 300;  // without a response: perhaps no connection is free
const STOP_AGAIN_MS = 300;
const STOP_TRIES_MS = 10000;
const OTHER_WAYS = "Use the robots' own switches, or lab stop in a terminal.";

const words = (name) => String(name ?? "").replaceAll("_", " ");

export class Controls {
  control = null;  // whether the server accepts requests from this page; null: unknown
  stopText = "";
  #stream;
  #why = "";
  #stop = null;  // topic `stop`
  #since = 0;    // [ms] when the stop began, as observed here
  #asked = "";   // text while a sent stop has no effect yet
  #failure = "";
  #unsent = false;  // whether the failure is a stop that was not accepted
  #sending = null;  // the stop that is being sent
  #attempt = -1;    // of the stream, at which the permissions were requested
  #questions = 0;

  constructor(stream) {
    this.#stream = stream;
    find("stop").addEventListener("click", () => this.stop("button on the page"));
    confirmButton(
        find("release-place"), "release the stop …", "The robots will move again.", "release",
        () => this.#release());
    confirmButton(
        find("end-place"), "end the run …", "The run ends now and its data are kept.",
        "end the run", () => this.#send("end", {why: "from the page"}));
    const pause = el("button", {type: "button", id: "pause", text: "pause the script"});
    pause.addEventListener("click", () => this.#send(this.#paused() ? "resume" : "pause"));
    find("pause-place").append(pause);
    this.#form("mark-form", async () => {
      const text = find("mark-text").value.trim();
      if (text && await this.#send("mark", {text})) find("mark-text").value = "";
    });
    const level = find("light-level");
    level.addEventListener("input", () => {
      find("light-value").value = `${level.value} %`;
    });
    this.#form(
        "light-form",
        () => this.#send(
            "light",
            {intensity: Number(level.value) / 100, hold_s: Number(find("light-hold").value)}));
    find("light-release").addEventListener("click", () => this.#send("release_light"));
    stream.on("stop", (stop) => this.#takeStop(stop), () => this.#takeStop(null));
    stream.on(
        "note", (note) => this.#say(`${timeOfDay(note.t_us)} ${words(note.request)}: ${note.text}`));
    stream.on(
        "script", () => setText(pause, this.#paused() ? "resume the script" : "pause the script"));
    stream.on("lab", () => {
      if (!this.#unsent) this.#failure = "";
      this.#enable();
    });
    stream.on("pulse", () => {
      if (this.#attempt === stream.attempts) return;
      this.#attempt = stream.attempts;
      this.#loadPermissions();
    });
    addEventListener("hashchange", () => this.#loadPermissions());
    this.#enable();
    setInterval(() => this.#showStop(), 100);
  }

  /**
   * Sends an emergency stop until the server accepts it. Topic `stop` then shows the confirmations
   * of the robots.
   */
  async stop(reason) {
    if (this.#replay())
      return this.#fail("This is a recorded run without robots; nothing was sent.");
    if (this.control === false)
      return this.#fail(`This page cannot stop the robots: ${this.#why}. ${OTHER_WAYS}`);
    const sending = this.#sending = {};  // a later stop or a release replaces it
    this.#asked = "stop requested, waiting for the robots";
    this.#fail("");
    if (this.#stop?.state !== "stopping") this.#since = performance.now();
    const end = performance.now() + STOP_TRIES_MS;
    for (;;) {
      const {ok, error} = await this.#sendStop(reason);
      if (sending !== this.#sending) return;
      const again = !ok && performance.now() < end;
      if (!again) this.#sending = null;
      if (again)
        this.#asked = "the stop is being sent again";
      else if (!ok || this.#stop?.state === "stopped")
        this.#asked = "";  // stopped already: the topic will not change
      this.#fail(ok ? "" : `STOP NOT SENT: ${error}. ${OTHER_WAYS}`, !ok);
      if (!again) return;
      await new Promise((done) => setTimeout(done, STOP_AGAIN_MS));
      if (sending !== this.#sending) return;
    }
  }

  async #sendStop(reason) {
    const crowded = setTimeout(() => this.#stream.makeRoom(), STOP_CROWDED_MS);
    try {
      return await sendRequest("stop", {reason}, STOP_TIMEOUT_MS);
    } finally {
      clearTimeout(crowded);
    }
  }

  #release() {
    this.#sending = null;
    this.#asked = "";
    this.#fail("");
    this.#send("release_stop");
  }

  #fail(text, unsent = false) {
    this.#failure = text;
    this.#unsent = unsent;
    this.#showStop();
  }

  async #send(name, fields = {}) {
    this.#say(`${words(name)} requested`);
    const {ok, error} = await sendRequest(name, fields);
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

  #replay = () => this.#stream.topics.get("lab")?.replay === true;

  /**
   * Without a response, the permissions stay as they were and are requested again at the next
   * pulse.
   */
  async #loadPermissions() {
    const question = ++this.#questions;
    const {ok, answer: me, error} = await ask("/api/me");
    if (question !== this.#questions) return;
    if (ok) {
      this.control = me?.control === true;
      this.#why = me?.why || "the server gives no reason";
      if (this.control && !this.#unsent) this.#failure = "";
    } else {
      this.#attempt = -1;
      if (this.control === null) this.#why = error;
    }
    this.#enable();
  }

  #enable() {
    const replay = this.#replay();
    const hint = find("read-only");
    hint.hidden = !replay && (this.control === true || !this.#why);
    if (replay)
      setText(
          hint, "This is a recorded run without robots. Play it with the slider below the arena.",
          "warn");
    else if (this.control === null)
      setText(
          hint, `Permissions unknown: ${this.#why}. The stop button works nevertheless.`, "warn");
    else
      setText(hint, `Read-only: ${this.#why}.`, "warn");
    for (const button of find("controls").querySelectorAll("button, input, select"))
      button.disabled = this.control !== true || replay;
    find("stop").disabled = this.control === false || replay;
    document.body.dataset.control = String(this.control);
    this.#showStop();
  }

  #takeStop(stop) {
    if (stop?.state === "stopping" && this.#stop?.state !== "stopping" && !this.#asked)
      this.#since = performance.now();
    const obeyed = stop?.state === "stopping" || stop?.state === "stopped";
    if (stop && stop.state !== "free") this.#asked = "";
    if (stop?.state !== this.#stop?.state && (obeyed || !this.#unsent)) {
      this.#failure = "";
      this.#unsent = false;
    }
    this.#stop = stop;
    this.#showStop();
  }

  #showStop() {
    const stop = this.#stop;
    const late = performance.now() - this.#since > 1000;
    const missing = stop?.unconfirmed ?? [];
    let text = "no robot has reported yet";
    let alarm = this.#failure;
    if (this.#replay())
      text = "recorded run: no robots to stop";
    else if (this.#asked) {
      text = this.#asked;
      if (late && !alarm) alarm = `The robots have not confirmed yet. ${OTHER_WAYS}`;
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
    find("release-place").hidden = !this.#sending && (!stop || stop.state === "free");
  }
}

function stopWords(stop) {
  const by = stop.by ? `, by ${stop.by}` : "";
  const took = typeof stop.took_ms === "number" ? `, ${Math.round(stop.took_ms)} ms` : "";
  const robots = stop.total === 1 ? "the robot" : `all ${stop.total} robots`;
  if (stop.state === "free")
    return stop.total ? `${stop.total === 1 ? "the robot is" : robots + " are"} free to move` :
                        "no robot has reported yet";
  if (stop.state === "stopping")
    return `stopping: ${stop.confirmed} of ${stop.total} confirmed${by}`;
  if (stop.state === "stopped") return `stopped: ${robots}${took}${by}`;
  if (stop.state === "releasing") return `releasing: ${stop.confirmed} of ${stop.total} confirmed`;
  return String(stop.state);
}
