// The buttons. A button says what was asked; only the robots' own status says that it was done.

import {ask, wish} from "./api.js";
import {confirmButton, el, find, setText} from "./dom.js";
import {list, timeOfDay} from "./format.js";

const STOP_PATIENCE_MS = 1500;
const STOP_CROWDED_MS = 300;  // no answer for so long: perhaps no connection is free
const STOP_AGAIN_MS = 300;
const STOP_TRIES_MS = 10000;
const OTHER_WAYS = "Use the robots' own switches, or lab stop in a terminal.";

const words = (wished) => String(wished ?? "").replaceAll("_", " ");

export class Controls {
  control = null;  // whether the server takes wishes from here; null: it has not said yet
  stopText = "";
  #stream;
  #why = "";
  #stop = null;  // topic
  #since = 0;    // [ms] when the stop began, as far as this page knows
  #asked = "";   // what was asked of the server and is not yet told back
  #failure = "";
  #unsent = false;  // the failure is a stop that was not taken
  #sending = null;  // the stop that is being sent
  #attempt = -1;    // of the stream, when the server said what may be done from here
  #questions = 0;

  constructor(stream) {
    this.#stream = stream;
    find("stop").addEventListener("click", () => this.stop("button on the page"));
    confirmButton(
        find("release-place"), "release the stop …", "Robots will move again.", "release",
        () => this.#release());
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
    stream.on("stop", (stop) => this.#takeStop(stop), () => this.#takeStop(null));
    stream.on(
        "note", (note) => this.#say(`${timeOfDay(note.t_us)} ${words(note.wish)}: ${note.text}`));
    stream.on(
        "script", () => setText(pause, this.#paused() ? "resume the script" : "pause the script"));
    stream.on("lab", () => {
      if (!this.#unsent) this.#failure = "";
      this.#enable();
    });
    stream.on("pulse", () => {
      if (this.#attempt === stream.attempts) return;
      this.#attempt = stream.attempts;
      this.#askMe();
    });
    addEventListener("hashchange", () => this.#askMe());
    this.#enable();
    setInterval(() => this.#showStop(), 100);
  }

  /**
   * Emergency stop, sent until the server takes it. The robots' status tells what came of it (topic
   * `stop`).
   */
  async stop(reason) {
    if (this.#replay()) return this.#fail("A recorded run: no robot listens, nothing was sent.");
    if (this.control === false)
      return this.#fail(`This page cannot stop the robots: ${this.#why}. ${OTHER_WAYS}`);
    const sending = this.#sending = {};  // a later one, or a release, takes its place
    this.#asked = "stop asked for, waiting for the robots";
    this.#fail("");
    if (this.#stop?.state !== "stopping") this.#since = performance.now();
    const end = performance.now() + STOP_TRIES_MS;
    for (;;) {
      const {ok, error} = await this.#sendStop(reason);
      if (sending !== this.#sending) return;
      const again = !ok && performance.now() < end;
      if (!again) this.#sending = null;
      if (again)
        this.#asked = "the stop is sent again";
      else if (!ok || this.#stop?.state === "stopped")
        this.#asked = "";  // stopped already: there is no news to wait for
      this.#fail(ok ? "" : `STOP NOT SENT: ${error}. ${OTHER_WAYS}`, !ok);
      if (!again) return;
      await new Promise((done) => setTimeout(done, STOP_AGAIN_MS));
      if (sending !== this.#sending) return;
    }
  }

  async #sendStop(reason) {
    const crowded = setTimeout(() => this.#stream.makeRoom(), STOP_CROWDED_MS);
    try {
      return await wish("stop", {reason}, STOP_PATIENCE_MS);
    } finally {
      clearTimeout(crowded);
    }
  }

  #release() {
    this.#sending = null;
    this.#asked = "";
    this.#fail("");
    this.#wish("release_stop");
  }

  #fail(text, unsent = false) {
    this.#failure = text;
    this.#unsent = unsent;
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

  #replay = () => this.#stream.topics.get("lab")?.replay === true;

  /** What the server does not say stays as it was, and is asked again with the next pulse. */
  async #askMe() {
    const question = ++this.#questions;
    const {ok, answer: me, error} = await ask("/api/me");
    if (question !== this.#questions) return;
    if (ok) {
      this.control = me?.control === true;
      this.#why = me?.why || "the server does not say why";
      if (this.control && !this.#unsent) this.#failure = "";
    } else {
      this.#attempt = -1;
      if (this.control === null) this.#why = error;
    }
    this.#enable();
  }

  #enable() {
    const replay = this.#replay();
    const said = find("read-only");
    said.hidden = !replay && (this.control === true || !this.#why);
    if (replay)
      setText(
          said, "A recorded run: no robot listens. The slider below the arena plays it.", "warn");
    else if (this.control === null)
      setText(said, `May this page command? ${this.#why}. A stop is sent all the same.`, "warn");
    else
      setText(said, `Read-only: ${this.#why}.`, "warn");
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
    let text = "no robot has been heard yet";
    let alarm = this.#failure;
    if (this.#replay())
      text = "a recorded run: nobody obeys";
    else if (this.#asked) {
      text = this.#asked;
      if (late && !alarm) alarm = `No word from the robots yet. ${OTHER_WAYS}`;
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
                        "no robot has been heard yet";
  if (stop.state === "stopping")
    return `stopping: ${stop.confirmed} of ${stop.total} confirmed${by}`;
  if (stop.state === "stopped") return `stopped: ${robots}${took}${by}`;
  if (stop.state === "releasing") return `releasing: ${stop.confirmed} of ${stop.total} confirmed`;
  return String(stop.state);
}
