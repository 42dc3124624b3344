// The labs that run on this machine, at the top of a page without a lab.

import {get} from "./api.js";
import {el, find, pollWhileSeen, setText} from "./dom.js";

const PERIOD_MS = 1000;

export class Labs {
  #shown = "";

  constructor() {
    pollWhileSeen(find("labs-section"), PERIOD_MS, () => this.load());
  }

  async load() {
    const [labs, started] = await Promise.all([get("/api/labs"), get("/api/started")]);
    if (!labs) return setText(find("labs-text"), "the server does not list the running labs");
    const all = labs.map((lab) => ({
                           text: lab.name + (lab.replay ? " (a recorded run)" : ""),
                           title: lab.directory,
                           address: lab.address
                         }));
    // A run in virtual time has no bus, and so it is not a lab.
    const here = started?.state === "running" && !labs.some((lab) => lab.name === started.run);
    if (here) all.push({text: `${started.run ?? "a run"} (started here)`, address: started.address});
    setText(
        find("labs-text"),
        all.length ? `running: ${all.length}` :
                     "no lab is running: start an experiment below, or with lab run FILE");
    this.#list(all);
    return undefined;
  }

  #list(all) {
    const key = JSON.stringify(all);
    if (this.#shown === key) return;
    this.#shown = key;
    find("labs").replaceChildren(...all.map(({text, title, address}) => {
      const has_page = /^https?:\/\//.test(address ?? "");
      return el(
          "li", {title}, `${text} `,
          has_page ? el("a", {href: address, target: "_blank", rel: "noopener", text: "its page"}) :
                     el("span", {class: "quiet", text: "without a page"}));
    }));
  }
}
