// A table of estimates with confidence intervals, and a chart of one of them against time.

import {Chart} from "./chart.js";
import {el, fillSelect, fillTable, find} from "./dom.js";
import {DASH, number, unit, withError} from "./format.js";
import {programNamed} from "./programs.js";

const deviation = (e) =>
    (typeof e.theory === "number" && e.sigma > 0 ? (e.value - e.theory) / e.sigma : null);

const COLUMNS = [
  {head: "program", text: (row) => row.program},
  {head: "quantity", text: (row) => row.name},
  {head: "measured", right: true, text: (row) => withError(row.value, row.sigma)},
  {head: "unit", text: (row) => unit(row.unit)},
  {
    head: "95 % interval",
    right: true,
    text: (row) => (row.low === null ? DASH : `${number(row.low, 4)} … ${number(row.high, 4)}`)
  },
  {head: "theory", right: true, text: (row) => number(row.theory, 4)},
  {
    head: "z",
    right: true,
    text: (row) => number(deviation(row), 2),
    kind: (row) => (Math.abs(deviation(row)) > 3 ? "bad" : "")
  },
  {head: "method and remarks", text: (row) => row.note || ""},
];

export class Estimates {
  #stream;
  #curves;
  #choice = el("select", {"aria-label": "quantity shown against time"});
  #chart;

  constructor(stream, curves) {
    this.#stream = stream;
    this.#curves = curves;
    this.#chart = new Chart(find("chart-history"), {
      title: "Estimate against time",
      extra: [this.#choice],
      x: {label: "time (s)"},
      y: {label: ""},
      empty: "no estimate yet"
    });
    this.#choice.addEventListener("change", () => this.#draw());
    stream.on("history/", () => this.#draw());
    curves.onChange((pools) => {
      fillTable(
          find("estimates"), COLUMNS,
          pools.flatMap(
              (pool) => (pool.estimates ??
                         []).map((estimate) => ({...estimate, program: pool.program}))));
      this.#draw();
    });
  }

  chart = () => this.#chart;

  #draw() {
    const histories = this.#stream.all("history/")
                          .map(([, history]) => history)
                          .filter((history) => history && this.#curves.shows(history.program));
    const names = [...new Set(
        histories.flatMap((history) => history.estimates.map((estimate) => estimate.name)))];
    fillSelect(this.#choice, names.map((name) => [name, name]));
    const name = this.#choice.value;
    const series = [];
    const rows = [];
    let named = "";
    for (const history of histories) {
      const estimate = history.estimates.find((one) => one.name === name);
      if (!estimate) continue;
      named = unit(estimate.unit);
      const {color} = programNamed(history.program);
      const x = history.t_s;
      series.push({kind: "band", color, x, low: estimate.low, high: estimate.high});
      series.push({kind: "line", label: history.program, color, x, y: estimate.value});
      if (typeof estimate.theory === "number") {
        series.push({
          kind: "line",
          color,
          dash: "6 4",
          x: [x[0], x[x.length - 1]],
          y: [estimate.theory, estimate.theory]
        });
      }
      x.forEach((t, i) => rows.push([
        history.program, t, estimate.value[i], estimate.low[i], estimate.high[i], estimate.theory
      ]));
    }
    if (series.length) {
      series.push(
          {kind: "line", label: "theory", color: "currentColor", dash: "6 4", x: [], y: []});
      series.push({
        kind: "band",
        label: "95 % interval",
        color: "currentColor",
        x: [],
        y: [],
        low: [],
        high: []
      });
    }
    this.#chart.setY({label: named ? `${name} (${named})` : name});
    const head = (key) => (named ? `${key} (${named})` : key);
    this.#chart.show(series, {
      columns:
          ["program", "time (s)", head(`${name} value`), head("low"), head("high"), head("theory")],
      rows
    });
  }
}
