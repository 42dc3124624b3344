// Starting an experiment: choose, set, check, start.

import {get, post} from "./api.js";
import {el, fillSelect, find, pollWhileSeen, setText} from "./dom.js";

const CHECK_PATIENCE_MS = 30000;

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
    pollWhileSeen(find("start-form"), 1000, () => this.#running && this.#look());
  }

  async #load() {
    this.#experiments = (await get("/api/experiments")) ?? [];
    fillSelect(
        find("start-file"),
        this.#experiments.map(
            (one) => [one.file, `${one.name}${one.shipped ? "" : ` (${one.file})`}`]));
    this.#describe();
    this.#look();
  }

  #describe() {
    const chosen = this.#experiments.find((one) => one.file === find("start-file").value);
    setText(
        find("start-description"),
        chosen ? `${chosen.description ?? ""} (${chosen.file})` : "no experiment file was found");
  }

  #order = () => ({
    file: find("start-file").value,
    set: find("start-set").value.split("\n").map((line) => line.trim()).filter((line) => line),
  });

  #say(text, kind = "") {
    setText(find("start-output"), text, kind);
  }

  async #check() {
    this.#say("checking");
    const {ok, answer, error} = await post("/api/check", this.#order(), CHECK_PATIENCE_MS);
    if (!ok)
      this.#say(error, "bad");
    else
      this.#say(
          answer.text || (answer.ok ? "nothing to say against it" : "not sound"),
          answer.ok ? "" : "bad");
    return ok && answer.ok;
  }

  async #start() {
    if (!await this.#check()) return;
    const {ok, error} = await post(
        "/api/start", {...this.#order(), virtual_time: find("start-virtual").checked},
        CHECK_PATIENCE_MS);
    if (!ok) return this.#say(error, "bad");
    this.#running = true;
    return this.#look();
  }

  async #look() {
    const told = await get("/api/started");
    if (!told || told.state === "none") return;
    this.#running = told.state === "running";
    const end = told.state === "ended" ?
        `\nended with code ${told.code ?? "?"}${told.run ? `: ${told.run}` : ""}` :
                                                           "";
    this.#say(`${told.output ?? ""}${end}`, told.state === "ended" && told.code ? "bad" : "");
    const sound = this.#running && /^https?:\/\//.test(told.address ?? "");
    find("start-link")
        .replaceChildren(
            ...(sound ? [el("a", {
              href: told.address,
              target: "_blank",
              rel: "noopener",
              text: "the page of this experiment"
            })] :
                        []));
  }
}
