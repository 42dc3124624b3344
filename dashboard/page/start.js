// Checks and starts experiments.

import {get, post} from "./api.js";
import {el, fillSelect, find, pollWhileSeen, setText} from "./dom.js";

const CHECK_TIMEOUT_MS = 30000;

export class Start {
  #experiments = [];
  #running = false;

  constructor(stream, controls) {
    let asked = false;
    stream.on("pulse", () => {
      if (!asked) this.#load();
      asked = true;
      for (const id of ["start-check", "start-go"])
        find(id).disabled = !controls.control || this.#running;
    });
    find("start-file").addEventListener("change", () => this.#describe());
    find("start-check").addEventListener("click", () => this.#check());
    find("start-form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.#start();
    });
    pollWhileSeen(find("start-form"), 1000, () => this.#running && this.#update());
  }

  async #load() {
    this.#experiments = (await get("/api/experiments")) ?? [];
    fillSelect(
        find("start-file"),
        this.#experiments.map(
            (one) => [one.file, `${one.name}${one.shipped ? "" : ` (${one.file})`}`]));
    this.#describe();
    this.#update();
  }

  #describe() {
    const chosen = this.#experiments.find((one) => one.file === find("start-file").value);
    setText(
        find("start-description"),
        chosen ? `${chosen.description ?? ""} (${chosen.file})` : "no experiment files found");
  }

  #selection = () => ({
    file: find("start-file").value,
    set: find("start-set").value.split("\n").map((line) => line.trim()).filter((line) => line),
  });

  #say(text, kind = "") {
    setText(find("start-output"), text, kind);
  }

  async #check() {
    this.#say("checking");
    const {ok, answer, error} = await post("/api/check", this.#selection(), CHECK_TIMEOUT_MS);
    if (!ok)
      this.#say(error, "bad");
    else
      this.#say(
          answer.text || (answer.ok ? "no problems found" : "the experiment has errors"),
          answer.ok ? "" : "bad");
    return ok && answer.ok;
  }

  async #start() {
    if (!await this.#check()) return;
    const {ok, error} = await post(
        "/api/start", {...this.#selection(), virtual_time: find("start-virtual").checked},
        CHECK_TIMEOUT_MS);
    if (!ok) return this.#say(error, "bad");
    this.#running = true;
    return this.#update();
  }

  async #update() {
    const started = await get("/api/started");
    if (!started || started.state === "none") return;
    this.#running = started.state === "running";
    const end = started.state === "ended" ?
        `\nended with code ${started.code ?? "?"}${started.run ? `: ${started.run}` : ""}` :
                                                                 "";
    this.#say(
        `${started.output ?? ""}${end}`, started.state === "ended" && started.code ? "bad" : "");
    const has_page = this.#running && /^https?:\/\//.test(started.address ?? "");
    find("start-link")
        .replaceChildren(
            ...(has_page ? [el("a", {
              href: started.address,
              target: "_blank",
              rel: "noopener",
              text: "page of this experiment"
            })] :
                           []));
  }
}
