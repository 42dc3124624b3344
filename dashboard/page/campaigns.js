// Campaigns of lab sweep: how far they are, and their pages, which are drawn anew while they run.

import {get} from "./api.js";
import {el, fillTable, find, pollWhileSeen} from "./dom.js";
import {DASH, seconds} from "./format.js";

const PERIOD_MS = 5000;

export class Campaigns {
  constructor(stream) {
    find("runs-refresh").addEventListener("click", () => this.load());
    let asked = false;
    stream.on("pulse", () => {
      if (!asked) this.load();
      asked = true;
    });
    pollWhileSeen(find("runs-section"), PERIOD_MS, () => this.load());
  }

  async load() {
    const campaigns = await get("/api/campaigns");
    find("campaigns-section").hidden = !campaigns?.length;
    if (!campaigns) return;
    fillTable(
        find("campaigns"),
        [
          {head: "campaign", text: (one) => one.name},
          {
            head: "last change (UTC)",
            text: (one) => (one.updated_utc ?? DASH).replace("T", " ").replace("Z", "")
          },
          {head: "runs done", right: true, fill: progress},
          {
            head: "failed",
            right: true,
            text: (one) => String(one.failed),
            kind: (one) => (one.failed > 0 ? "bad" : "")
          },
          {head: "", text: state},
          {head: "page", fill: page},
        ],
        campaigns);
  }
}

function state(one) {
  if (!one.running) return one.done + one.failed < one.total ? "stopped" : "";
  const where = one.live ? "on the lab" : "running";
  return one.seconds_left === null ? where : `${where}, ${seconds(one.seconds_left)} left`;
}

function progress(cell, one) {
  const text = `${one.done} of ${one.total}`;
  if (cell.progress === text) return;
  cell.progress = text;
  cell.className = "right";
  cell.replaceChildren(
      el("progress", {max: one.total, value: one.done, "aria-label": `runs of ${one.name}`}),
      ` ${text}`);
}

function page(cell, one) {
  const address = one.page ? `/api/campaigns/${encodeURIComponent(one.name)}/index.html` : null;
  if (cell.address === address) return;
  cell.address = address;
  cell.replaceChildren(
      address ? el("a", {href: address, target: "_blank", rel: "noopener", text: "page"}) :
                el("span", {class: "quiet", text: "none yet"}));
}
