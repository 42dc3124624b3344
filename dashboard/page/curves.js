// Measured curves of all robots or of one robot (MSD, angular MSD, C(l), run times), with what is
// expected (the laws of the programs) and the formulas of the paper.

import {get} from "./api.js";
import {Chart} from "./chart.js";
import {drawWhenSeen, el, fillSelect, find, pollWhileSeen, setText} from "./dom.js";
import {number, seconds, unit} from "./format.js";
import {programNamed} from "./programs.js";

const PAPER_DASH = "6 4";

/** The series of one curve for a chart. @param look {color, symbol, ink, label} */
export function curveSeries(curve, look, paper) {
  const lag = curve.lag ?? curve.lag_cm;
  const note = (i) =>
      `${look.label}, lag ${number(lag[i])} ${lagUnit(curve)}: ${number(curve.value[i])} ± ` +
      `${number(curve.sigma[i], 2)} ${unit(curve.unit)}; expected ${number(curve.exact?.[i])}; ` +
      `${curve.windows?.[i] ?? "?"} windows${curve.biased?.[i] ? "; biased: no verdict" : ""}`;
  const series = [{
    kind: "points",
    label: look.label,
    color: look.color,
    symbol: look.symbol,
    x: lag,
    y: curve.value,
    sigma: curve.sigma,
    hollow: curve.biased?.map(Boolean),
    note
  }];
  if (curve.exact)
    series.push({kind: "line", color: look.color, x: lag, y: curve.exact, dash: look.dash});
  if (paper && curve.paper)
    series.push({kind: "line", color: look.color, dash: PAPER_DASH, x: lag, y: curve.paper});
  return series;
}

const lagUnit = (curve) => (curve.lag_cm ? "cm" : "s");
const MEANINGS = [
  {
    kind: "points",
    label: "biased, no verdict",
    color: "currentColor",
    hollow: [true],
    sampleHollow: true,
    x: [],
    y: []
  },
  {kind: "line", label: "expected", color: "currentColor", x: [], y: []},
  {kind: "line", label: "paper's formula", color: "currentColor", dash: PAPER_DASH, x: [], y: []},
];

/** @param list [{who, curve}] */
export function curveTable(list) {
  const first = list[0]?.curve;
  const name = (key) => (first?.unit && first.unit !== "1" ? `${key} (${first.unit})` : key);
  const columns = [
    "program", `lag (${first ? lagUnit(first) : "s"})`, name("value"), name("sigma"), name("exact"),
    name("paper"), "windows", "biased"
  ];
  const rows = list.flatMap(
      ({who, curve}) =>
          (curve.lag ?? curve.lag_cm)
              .map(
                  (lag, i) =>
                      [who, lag, curve.value[i], curve.sigma[i], curve.exact?.[i], curve.paper?.[i],
                       curve.windows?.[i], curve.biased?.[i] ? 1 : 0]));
  return {columns, rows};
}

export class Curves {
  #stream;
  #charts;
  #runtimes;
  #hidden = new Set();
  #single = null;  // the curves of one robot, null: not loaded
  #listeners = [];

  constructor(stream) {
    this.#stream = stream;
    const lag = {label: "lag (s)", log: true};
    this.#charts = {
      msd: new Chart(find("chart-msd"), {title: "MSD", x: lag, y: {label: "MSD (cm²)", log: true}}),
      angular_msd: new Chart(
          find("chart-angular"),
          {title: "Angular MSD", x: lag, y: {label: "angular MSD (rad²)", log: true}}),
      C_l: new Chart(find("chart-cl"), {
        title: "C(l)",
        x: {label: "path length l (cm)"},
        y: {label: "C(l)"},
        empty: "not measured for these programs yet"
      }),
    };
    this.#runtimes = new Chart(find("chart-runtimes"), {
      title: "Run times",
      x: {label: "run time (s)"},
      y: {label: "runs", log: true},
      empty: "no program with runs and turns has run yet"
    });
    stream.on("lab", () => {
      this.#programs();
      this.#pools();  // another run has no curves yet
      this.#runTimes();
    });
    // The pools arrive one by one, each once per second; they are drawn together.
    const pools = drawWhenSeen(find("curves-section"), () => this.#pools(), 500);
    stream.on("pool/", pools, () => {
      this.#single = null;  // load the robot's curves of the same time too
      pools();
    });
    stream.on("runtimes/", drawWhenSeen(find("curves-section"), () => this.#runTimes(), 500));
    stream.on("robots", (robots) => fillSelect(find("curves-source"), [
                          ["", "all robots together"],
                          ...robots.map((robot) => [String(robot.id), `robot ${robot.id} alone`])
                        ]));
    find("curves-source").addEventListener("change", () => {
      this.#single = null;
      this.#loadSingle();
      this.#pools();
    });
    find("curves-paper").addEventListener("change", () => this.#pools());
    pollWhileSeen(find("curves-section"), 2000, () => this.#loadSingle());
  }

  /** Calls call(pools) when the displayed pools have changed. */
  onChange(call) {
    this.#listeners.push(call);
  }

  charts = () => ({...this.#charts, runtimes: this.#runtimes});

  shows = (program) => !this.#hidden.has(program);

  async #loadSingle() {
    const id = find("curves-source").value;
    if (!id) return;
    const found = await get(`/api/ask/analysis?which=${encodeURIComponent(id)}`);
    if (find("curves-source").value !== id) return;
    this.#single = found ?? [];
    this.#pools();
  }

  #programs() {
    const lab = this.#stream.topics.get("lab");
    find("curves-programs").replaceChildren(...lab.programs.map(({name}) => {
      const program = programNamed(name);
      const swatch = el("span", {class: "swatch", text: program.letter});
      swatch.style.background = program.color;
      swatch.style.color = program.ink;
      const box = el("input", {type: "checkbox", checked: !this.#hidden.has(name)});
      box.addEventListener("change", () => {
        if (box.checked)
          this.#hidden.delete(name);
        else
          this.#hidden.add(name);
        this.#pools();
        this.#runTimes();
      });
      return el("label", {class: "chip", title: program.text ?? ""}, box, swatch, name);
    }));
  }

  #pools() {
    const single = find("curves-source").value !== "";
    const all = single ? this.#single ?? [] : this.#stream.all("pool/").map(([, pool]) => pool);
    const pools = all.filter((pool) => pool && this.shows(pool.program));
    setText(
        find("curves-missing"),
        pools.length ? "" : "no curves yet: they appear after some seconds of free motion");
    this.#verdicts(pools);
    const paper = find("curves-paper").checked;
    for (const [name, chart] of Object.entries(this.#charts)) {
      const list = pools.flatMap(
          (pool) => (pool.curves ?? [])
                        .filter((curve) => curve.name === name)
                        .map((curve) => ({who: pool.program, curve})));
      const series = list.flatMap(({who, curve}) => {
        const {color, symbol} = programNamed(who);
        return curveSeries(curve, {color, symbol, label: who}, paper);
      });
      chart.show(
          series.length ? [...series, ...MEANINGS.slice(0, paper ? 3 : 2)] : [], curveTable(list));
    }
    for (const call of this.#listeners) call(pools);
  }

  #verdicts(pools) {
    const words = {
      agrees: ["good", "agrees with its program"],
      disagrees: ["bad", "deviates from its program"]
    };
    find("verdicts").replaceChildren(...pools.map((pool) => {
      const [plain, word] = words[pool.verdict] ?? ["quiet", "undecided"];
      // As in the report: a verdict is about free motion.
      const reserve = pool.verdict === "agrees" && pool.contact_share > 0.1;
      const kind = reserve ? "warn" : plain;
      const text = reserve ? `${word} in its free motion` : word;
      const parts = [
        `max |z| ${number(pool.max_z, 2)}`, `${seconds(pool.observed_s)} observed`,
        `${pool.reversals ?? 0} reversals`, `${number(100 * pool.contact_share, 2)} % in contact`
      ];
      return el(
          "li", {}, el("strong", {text: `${pool.program}: `}), el("span", {class: kind, text}),
          el("span", {class: "quiet", text: ` (${parts.join(", ")})`}));
    }));
  }

  #runTimes() {
    const series = [];
    const rows = [];
    const notes = [];
    for (const [, histogram] of this.#stream.all("runtimes/")) {
      if (!histogram || !this.shows(histogram.program)) continue;
      const {color} = programNamed(histogram.program);
      const {edges_s: edges, counts, gamma_per_s: gamma, runs, mean_s: mean} = histogram;
      series.push(
          {kind: "bars", label: `${histogram.program}, ${runs} runs`, color, edges, y: counts});
      const law = counts.map(
          (_, i) => runs * (Math.exp(-gamma * edges[i]) - Math.exp(-gamma * edges[i + 1])));
      if (gamma > 0) {
        series.push({
          kind: "line",
          label: "exponential law",
          color,
          x: counts.map((_, i) => (edges[i] + edges[i + 1]) / 2),
          y: law
        });
        notes.push(
            `${histogram.program}: mean ${number(mean)} s, programmed ${number(1 / gamma)} s`);
      }
      counts.forEach(
          (count, i) => rows.push([histogram.program, edges[i], edges[i + 1], count, law[i]]));
    }
    this.#runtimes.show(
        series, {columns: ["program", "from (s)", "to (s)", "runs", "law"], rows},
        notes.join("; "));
  }
}
