// Collective states: the arena coloured by cluster, local density or heading, g(r), polar order and
// largest cluster over time, and a table of all numbers.

import {Chart} from "./chart.js";
import {drawWhenSeen, el, fillSelect, fillTable, find, setText} from "./dom.js";
import {DASH, number, seconds, unit, withError} from "./format.js";
import {programNamed} from "./programs.js";

// Okabe and Ito, without black: the largest clusters. Robots that are alone are grey.
const CLUSTERS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#F0E442"];
const ALONE = "#C4C8CC";
const DENSEST = 0.91;  // packing fraction of discs that touch six others
// Viridis (Smith and van der Walt 2015).
const VIRIDIS = ["#440154", "#414487", "#2a788e", "#22a884", "#7ad151", "#fde725"];

const density = window.d3.scale.linear()
                    .domain(VIRIDIS.map((_, i) => (DENSEST * i) / (VIRIDIS.length - 1)))
                    .range(VIRIDIS)
                    .clamp(true);
const heading = (angle) => window.d3.hsl((angle * 180) / Math.PI, 0.6, 0.55).toString();

const WORDS = new Map(Object.entries({
  polar_order: "polar order",
  nematic_order: "nematic order",
  hexatic_order: "hexatic order",
  hexatic_order_global: "hexatic order, global",
  largest_cluster: "largest cluster (robots)",
  mean_cluster: "mean cluster of a robot (robots)",
  clusters: "clusters",
  clustered_share: "share of robots in clusters",
  local_density: "local packing fraction",
  local_density_scatter: "scatter of the local packing fraction",
  speed: "mean speed, with contacts",
  square_speed: "mean squared speed",
  touching_share: "share of time touching a robot",
  wall_share: "share of time at a wall",
  contact_time: "mean duration of a contact",
  wall_time: "mean stay at a wall",
  bimodality: "bimodality of the local density",
  number_fluctuation_exponent: "exponent of number fluctuations",
}));

const COLUMNS = [
  {head: "number", text: (row) => WORDS.get(row.name) ?? row.name.replaceAll("_", " ")},
  {head: "now", right: true, text: (row) => number(row.now)},
  {head: "average", right: true, text: (row) => withError(row.mean, row.sigma)},
  {head: "unit", text: (row) => unit(row.unit)},
  {
    head: "95 % interval",
    right: true,
    text: (row) => (row.low === null ? DASH : `${number(row.low, 4)} … ${number(row.high, 4)}`)
  },
];

export class Crowd {
  #stream;
  #view;
  #charts;
  #canvas = find("crowd-arena");
  #members = new Map();
  #legend = "";

  constructor(stream, view) {
    this.#stream = stream;
    this.#view = view;
    const time = {label: "time (s)"};
    this.#charts = {
      pairs: new Chart(find("chart-pairs"), {
        title: "Pair distribution g(r)",
        x: {label: "distance (cm)"},
        y: {label: "g(r)", zero: true},
        empty: "needs two robots"
      }),
      order: new Chart(
          find("chart-order"),
          {title: "Polar order", x: time, y: {label: "polar order", zero: true}}),
      cluster: new Chart(
          find("chart-cluster"),
          {title: "Largest cluster", x: time, y: {label: "largest cluster (robots)", zero: true}}),
    };
    const draw = drawWhenSeen(find("crowd-section"), () => this.#draw(), 400);
    // What is hidden is never seen: the section appears with the first message.
    stream.on("crowd", () => {
      find("crowd-section").hidden = false;
      draw();
    }, () => {
      find("crowd-section").hidden = true;
    });
    stream.on("crowd/", draw, draw);
    for (const id of ["crowd-source", "crowd-colour"]) find(id).addEventListener("change", draw);
  }

  charts = () => this.#charts;

  #shown() {
    const source = find("crowd-source").value;
    return this.#stream.topics.get(source ? `crowd/${source}` : "crowd");
  }

  #draw() {
    const all = this.#stream.topics.get("crowd");
    if (!all) return;
    fillSelect(find("crowd-source"), [
      ["", "all robots"], ...this.#stream.all("crowd/").map(([, one]) => [one.program, one.program])
    ]);
    this.#members = new Map(all.members.map(([id, ...rest]) => [id, rest]));
    this.#drawArena();
    const shown = this.#shown() ?? all;
    const color = shown.program ? programNamed(shown.program).color : "#7A8792";
    setText(
        find("crowd-text"),
        `${number(shown.robots)} robots on average, ${seconds(shown.observed_s)} observed`);
    this.#drawPairs(shown, color);
    this.#drawHistory("order", "polar_order", shown, color);
    this.#drawHistory("cluster", "largest_cluster", shown, color);
    fillTable(find("crowd-numbers"), COLUMNS, shown.observables);
  }

  #colourOf(robot) {
    const [cluster, packing] = this.#members.get(robot.id) ?? [0, null];
    switch (find("crowd-colour").value) {
      case "density":
        return packing === null ? ALONE : density(packing);
      case "heading":
        return heading(robot.angle);
      default:
        return cluster ? CLUSTERS[(cluster - 1) % CLUSTERS.length] : ALONE;
    }
  }

  #drawArena() {
    const arena = this.#view.arena;
    const ratio = window.devicePixelRatio || 1;
    const width = this.#canvas.clientWidth * ratio;
    const scale = width / arena.width;
    this.#canvas.width = Math.round(width);
    this.#canvas.height = Math.round(arena.height * scale);
    const context = this.#canvas.getContext("2d");
    context.fillStyle = "#fff";
    context.fillRect(0, 0, this.#canvas.width, this.#canvas.height);
    const radius = arena.radius * scale;
    context.lineWidth = ratio;
    context.strokeStyle = "#333";
    for (const robot of arena.present()) {
      const [x, y] = [robot.x * scale, (arena.height - robot.y) * scale];
      context.fillStyle = this.#colourOf(robot);
      context.beginPath();
      context.arc(x, y, radius, 0, 2 * Math.PI);
      context.fill();
      context.moveTo(x, y);
      context.lineTo(x + radius * Math.cos(robot.angle), y - radius * Math.sin(robot.angle));
      context.stroke();
    }
    this.#drawLegend();
  }

  #drawLegend() {
    const chosen = find("crowd-colour").value;
    if (this.#legend === chosen) return;
    this.#legend = chosen;
    const swatch = (color, text) => {
      const sample = el("span", {class: "crowd-swatch"});
      sample.style.background = color;  // a style attribute is against the page's policy
      return el("span", {}, sample, ` ${text}`);
    };
    const legends = {
      cluster: [...CLUSTERS.slice(0, 3).map((color, i) => swatch(color, `cluster ${i + 1}`)),
                swatch(ALONE, "alone")],
      density: [0, 0.2, 0.4, 0.6, 0.8].map((value) => swatch(density(value), String(value))),
      heading: [0, 90, 180, 270].map(
          (angle) => swatch(heading((angle * Math.PI) / 180), `${angle}°`)),
    };
    find("crowd-legend").replaceChildren(...legends[chosen]);
  }

  #drawPairs(shown, color) {
    const curve = shown.curves.find((one) => one.name === "pair_distribution");
    const series = [];
    if (curve) {
      const {x, value, low, high} = curve;
      series.push({kind: "band", color, x, low, high});
      series.push({kind: "line", color, x, y: value});
      series.push(
          {kind: "line", color: "currentColor", dash: "4 4", x: [x[0], x.at(-1)], y: [1, 1]});
    }
    const rows = curve ? curve.x.map((x, i) => [x, curve.value[i], curve.low[i], curve.high[i]]) : [];
    this.#charts.pairs.show(
        series, {columns: ["distance (cm)", "g", "low", "high"], rows},
        "band: 95 % interval; 1: without correlation");
  }

  #drawHistory(chart, name, shown, color) {
    const history = shown.history;
    const line = history[name];
    const series = [];
    const rows = [];
    if (line && line.now.some((value) => value !== null)) {
      const x = history.t_s;
      series.push({kind: "band", color, x, low: line.low, high: line.high});
      series.push({kind: "line", color, x, y: line.now});
      x.forEach((t, i) => rows.push([t, line.now[i], line.low[i], line.high[i]]));
    }
    this.#charts[chart].show(
        series, {columns: ["time (s)", name, "low of the average", "high of the average"], rows},
        "line: at that time; band: 95 % interval of the average up to it");
  }
}
