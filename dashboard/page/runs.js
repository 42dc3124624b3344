// Past runs with their verdicts and reports, and a comparison of two runs.

import {ask, get} from "./api.js";
import {Chart} from "./chart.js";
import {curveSeries, curveTable} from "./curves.js";
import {el, fillTable, find, setText} from "./dom.js";
import {DASH, number, seconds} from "./format.js";

const LOOKS =
    [{color: "#0072B2", symbol: "circle"}, {color: "#D55E00", symbol: "square", dash: "8 3 2 3"}];
const COMPARED = LOOKS.length;
const file = (run, name) =>
    `/api/runs/${encodeURIComponent(run)}/${name.split("/").map(encodeURIComponent).join("/")}`;

export class Runs {
  #chosen = [];
  #charts = {
    msd: new Chart(find("compare-msd"), {
      title: "MSD of two runs",
      x: {label: "lag (s)", log: true},
      y: {label: "MSD (cm²)", log: true}
    }),
    angular_msd: new Chart(find("compare-angular"), {
      title: "Angular MSD of two runs",
      x: {label: "lag (s)", log: true},
      y: {label: "angular MSD (rad²)", log: true}
    }),
  };

  constructor(stream) {
    find("runs-refresh").addEventListener("click", () => this.load());
    find("runs-compare").addEventListener("click", () => this.#compare());
    let ended = false;
    stream.on("script", (script) => {
      if (script.phase === "ended" && !ended)
        setTimeout(() => this.load(), 5000);  // its report takes some seconds
      ended = script.phase === "ended";
    });
    let asked = false;
    stream.on("pulse", () => {
      if (!asked) this.load();
      asked = true;
    });
  }

  charts = () => this.#charts;

  async load() {
    const runs = await get("/api/runs");
    if (!runs) return setText(find("runs-text"), "the server does not list the runs");
    // A run that is gone has no box that could be cleared.
    this.#chosen = this.#chosen.filter((name) => runs.some((run) => run.name === name));
    this.#judge();
    setText(
        find("runs-text"),
        runs.length ? `${runs.length} runs` : "no runs yet: create one with lab run FILE");
    fillTable(
        find("runs"),
        [
          {head: "", fill: (cell, run) => this.#box(cell, run)},
          {head: "", fill: (cell, run) => picture(cell, run)},
          {head: "run", text: (run) => run.name},
          {
            head: "start (UTC)",
            text: (run) => (run.start_utc ?? DASH).replace("T", " ").replace("Z", "")
          },
          {head: "duration", right: true, text: (run) => seconds(run.duration_s)},
          {head: "verdicts", fill: (cell, run) => verdicts(cell, run)},
          {
            head: "lost messages",
            right: true,
            text: (run) => (run.lost === null ? DASH : String(run.lost)),
            kind: (run) => (run.lost > 0 ? "bad" : "")
          },
          {
            head: "marked",
            text: (run) =>
                (run.marked               ? "faults" :
                     run.marked === false ? "" :
                                            DASH),
            kind: (run) => (run.marked ? "warn" : "")
          },
          {head: "report", fill: (cell, run) => report(cell, run)},
        ],
        runs);
    return undefined;
  }

  #box(cell, run) {
    if (cell.run === run.name) return;
    cell.run = run.name;
    const box = el("input", {
      type: "checkbox",
      "aria-label": `compare ${run.name}`,
      checked: this.#chosen.includes(run.name)
    });
    box.addEventListener("change", () => {
      this.#chosen = this.#chosen.filter((name) => name !== run.name);
      if (box.checked) this.#chosen.push(run.name);
      this.#judge();
    });
    cell.replaceChildren(box);
  }

  /** Says why the button does not work. */
  #judge() {
    const chosen = this.#chosen.length;
    find("runs-compare").disabled = chosen !== COMPARED;
    const change = chosen < COMPARED ? "select one more" : `clear ${chosen - COMPARED}`;
    setText(
        find("compare-text"),
        chosen === 0 || chosen === COMPARED ?
            "" :
            `${chosen} selected, ${COMPARED} can be compared: ${change}`);
  }

  async #compare() {
    const {answer, ok, error} =
        await ask(`/api/compare?runs=${this.#chosen.map(encodeURIComponent).join(",")}`);
    const found = ok ? answer : null;
    find("compare").hidden = !found;
    setText(find("runs-text"), ok ? "" : `these runs cannot be compared: ${error}`);
    for (const [name, chart] of Object.entries(this.#charts)) {
      const list =
          (found ?? [])
              .flatMap(
                  (one) => (one.curves ?? [])
                               .filter((curve) => curve.name === name)
                               .map(
                                   (curve) =>
                                       ({who: `${one.run} ${one.program}`, run: one.run, curve})));
      chart.show(
          list.flatMap(
              ({who, run, curve}) => curveSeries(
                  curve, {...LOOKS[Math.max(0, this.#chosen.indexOf(run)) % 2], label: who},
                  false)),
          curveTable(list));
    }
    find("compare").scrollIntoView({block: "nearest"});
  }
}

function picture(cell, run) {
  const source = run.thumbnail ? file(run.name, run.thumbnail) : null;
  if (cell.source === source) return;
  cell.source = source;
  cell.replaceChildren(
      ...(source ? [el("img", {src: source, alt: `trajectories of ${run.name}`, loading: "lazy"})] :
                   []));
}

function verdicts(cell, run) {
  // summary.json has "disagrees" for what pages and reports call "deviates".
  // A map: the verdict is any text of a file, such as "constructor", which every object has.
  const words = new Map([["agrees", ["good", "agrees"]], ["disagrees", ["bad", "deviates"]]]);
  const word = ({verdict, restricted}) => {
    const [kind, text] = words.get(verdict) ?? ["quiet", verdict ?? DASH];
    const reserve = restricted && verdict === "agrees";
    return el("span", {
      class: reserve ? "warn" : kind,
      text: reserve ? `${text} in its free motion` : text
    });
  };
  cell.replaceChildren(
      ...(run.verdicts ?? [])
          .map(
              (one) =>
                  el("div", {}, `${one.program}: `,
                     word(one),
                     typeof one.max_z === "number" ?
                         el("span", {class: "quiet", text: ` (max |z| ${number(one.max_z, 2)})`}) :
                         null)));
  if (run.problem) cell.append(el("div", {class: "quiet", text: run.problem}));
}

function report(cell, run) {
  cell.replaceChildren(
      ...(run.report ? [el("a", {
        href: file(run.name, "report.html"),
        target: "_blank",
        rel: "noopener",
        text: "report"
      })] :
                       [el("span", {class: "quiet", text: "none"})]));
}
