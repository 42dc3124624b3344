// A chart with axes, points with error bars, lines, bands and bars. d3 draws it when it is visible
// and has changed.

import {drawWhenSeen, el, setText} from "./dom.js";
import {csvText, download, standaloneSvg} from "./export.js";
import {number, raised} from "./format.js";

const d3 = window.d3;
const EDGE = {
  top: 8,
  right: 12,
  bottom: 38,
  left: 58
};
const finite = (value) => typeof value === "number" && Number.isFinite(value);

/**
 * A series: {kind, label, color, dash, x: [], y: [], ...}
 *   points: sigma: [] , hollow: [bool], symbol, note: i => text
 *   line
 *   band: low: [], high: [] instead of y
 *   bars: edges: [] (one more than y) instead of x
 */
export class Chart {
  #series = [];
  #table = {columns: [], rows: []};
  #mark;

  /** @param options {title, x: {label, log}, y: {label, log, zero}, empty} */
  constructor(holder, options) {
    this.options = options;
    this.holder = holder;
    holder.className = "chart";
    this.title = el("strong", {text: options.title});
    const button = (text, act) => el("button", {
      type: "button",
      text,
      "aria-label": `${options.title} as ${text}`,
      on: {click: act},
    });
    holder.append(el(
        "div", {class: "chart-head"}, this.title, ...(options.extra ?? []),
        button(
            "SVG",
            () => download(`${this.title.textContent}.svg`, this.svgText(), "image/svg+xml")),
        button(
            "CSV", () => download(`${this.title.textContent}.csv`, this.csvText(), "text/csv"))));
    this.svg = d3.select(holder).append("svg").attr("role", "img");
    this.legend = el("div", {class: "chart-legend"});
    this.note = el("p", {class: "chart-note"});
    holder.append(this.legend, this.note);
    this.#mark = drawWhenSeen(holder, () => this.#draw());
    let width = 0;
    new ResizeObserver(() => {
      if (holder.clientWidth === width) return;
      width = holder.clientWidth;
      this.#mark();
    }).observe(holder);
  }

  /** @param table {columns, rows} of the CSV file @param note a line below the chart */
  show(series, table, note = "") {
    this.#series = series;
    this.#table = table;
    this.noteText = note;
    this.#mark();
  }

  setTitle(text) {
    setText(this.title, text);
  }

  setY(y) {
    this.options.y = {...this.options.y, ...y};
  }

  svgText = () => standaloneSvg(this.svg.node());
  csvText = () => csvText(this.#table);

  /** For tests. */
  pointsDrawn = () => this.svg.selectAll(".point, .bar").size();

  #draw() {
    const width = Math.max(220, this.holder.clientWidth);
    const height = Math.round(Math.min(340, Math.max(210, width * 0.68)));
    const {x, y, empty} = this.options;
    this.svg.attr({width, height}).attr("aria-label", this.#summary());
    this.svg.selectAll("*").remove();
    setText(this.note, this.noteText ?? "");
    const [xs, ys] = [this.#domain("x", x), this.#domain("y", y)];
    if (!xs || !ys) {
      this.svg.append("text")
          .attr({x: width / 2, y: height / 2, "text-anchor": "middle", class: "quiet-text"})
          .text(empty ?? "nothing measured yet");
      this.legend.replaceChildren();
      return;
    }
    const inner = [width - EDGE.left - EDGE.right, height - EDGE.top - EDGE.bottom];
    const sx = (x.log ? d3.scale.log() : d3.scale.linear()).domain(xs).range([0, inner[0]]);
    const sy = (y.log ? d3.scale.log() : d3.scale.linear()).domain(ys).range([inner[1], 0]);
    const plot = this.svg.append("g").attr("transform", `translate(${EDGE.left},${EDGE.top})`);
    this.#axes(plot, sx, sy, inner);
    const clip = `clip-${this.holder.id}`;
    plot.append("clipPath").attr("id", clip).append("rect").attr({
      width: inner[0],
      height: inner[1]
    });
    const inside = plot.append("g").attr("clip-path", `url(#${clip})`);
    for (const kind of ["band", "bars", "points", "line"]) {
      for (const series of this.#series)
        if (series.kind === kind) DRAW[kind](inside, series, sx, sy, inner);
    }
    this.#drawLegend();
  }

  #summary() {
    const names = this.#series.filter((series) => series.label).map((series) => series.label);
    return `${this.title.textContent}: ${names.length ? [...new Set(names)].join(", ") : "empty"}`;
  }

  /** @return [minimum, maximum]; null if there are no values */
  #domain(axis, {log, zero}) {
    let [least, greatest] = [Infinity, -Infinity];
    const take = (value) => {
      if (!finite(value) || (log && value <= 0)) return;
      least = Math.min(least, value);
      greatest = Math.max(greatest, value);
    };
    for (const series of this.#series) {
      if (axis === "x")
        for (const value of series.x ?? series.edges ?? []) take(value);
      else {
        for (const key of ["y", "low", "high"])
          for (const value of series[key] ?? []) take(value);
        if (!log)
          series.sigma?.forEach((s, i) => {
            take(series.y[i] + s);
            take(series.y[i] - s);
          });
      }
    }
    if (least > greatest) return null;
    if (log) return axis === "x" ? [least / 1.15, greatest * 1.15] : [least / 1.5, greatest * 1.5];
    if (zero) [least, greatest] = [Math.min(0, least), Math.max(0, greatest)];
    const room = (greatest - least || Math.abs(greatest) || 1) * (axis === "x" ? 0.02 : 0.08);
    return [zero && least === 0 ? 0 : least - room, greatest + room];
  }

  #axes(plot, sx, sy, [width, height]) {
    const {x, y} = this.options;
    const axis = (scale, orient, log, span, size) => {
      const values =
          log ? logTicks(scale.domain()) : scale.ticks(span / (orient === "left" ? 40 : 70));
      return d3.svg.axis()
          .scale(scale)
          .orient(orient)
          .tickValues(values)
          .tickSize(size)
          .outerTickSize(0)
          .tickFormat(
              log ? tickText :
                    (value) => number(value, 3).replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, ""));
    };
    const down = `translate(0,${height})`;
    plot.append("g")
        .attr({class: "grid", transform: down})
        .call(axis(sx, "bottom", x.log, width, -height))
        .selectAll("text, path")
        .remove();
    plot.append("g")
        .attr("class", "grid")
        .call(axis(sy, "left", y.log, height, -width))
        .selectAll("text, path")
        .remove();
    plot.append("rect").attr({class: "frame", width, height});
    plot.append("g")
        .attr({class: "axis", transform: down})
        .call(axis(sx, "bottom", x.log, width, 4));
    plot.append("g").attr("class", "axis").call(axis(sy, "left", y.log, height, 4));
    plot.append("text").attr({x: width / 2, y: height + 33, "text-anchor": "middle"}).text(x.label);
    plot.append("text")
        .attr({transform: `translate(-46,${height / 2}) rotate(-90)`, "text-anchor": "middle"})
        .text(y.label);
  }

  #drawLegend() {
    const entries = this.#series.filter((series) => series.label).map((series) => {
      const sample = el("span", {});
      const svg = d3.select(sample).append("svg").attr({width: 24, height: 12, class: "chart"});
      const span = d3.scale.linear().domain([0, 24]).range([0, 24]);
      const middle = {
        ...series,
        x: [0, 24],
        y: [6, 6],
        low: [2, 2],
        high: [10, 10],
        edges: [2, 22],
        note: null
      };
      if (series.kind === "points")
        Object.assign(
            middle, {x: [12], y: [6], sigma: null, hollow: series.sampleHollow ? [true] : null});
      if (series.kind === "bars") middle.y = [2];
      DRAW[series.kind](svg, middle, span, span, [24, 12]);
      sample.append(series.label);
      return sample;
    });
    this.legend.replaceChildren(...entries);
  }
}

const DRAW = {
  line(plot, series, sx, sy) {
    const inLog = (scale) => scale.domain()[0] > 0 && scale.base;
    const sound = (i) => finite(series.x[i]) && finite(series.y[i]) &&
        (!inLog(sx) || series.x[i] > 0) && (!inLog(sy) || series.y[i] > 0);
    plot.append("path")
        .datum(d3.range(series.x.length))
        .attr({class: "line", stroke: series.color, "stroke-dasharray": series.dash ?? null})
        .attr(
            "d", d3.svg.line().defined(sound).x((i) => sx(series.x[i])).y((i) => sy(series.y[i])));
  },

  band(plot, series, sx, sy) {
    plot.append("path")
        .datum(d3.range(series.x.length))
        .attr({fill: series.color, opacity: 0.22, stroke: "none"})
        .attr(
            "d",
            d3.svg.area()
                .defined((i) => finite(series.low[i]) && finite(series.high[i]))
                .x((i) => sx(series.x[i]))
                .y0((i) => sy(series.low[i]))
                .y1((i) => sy(series.high[i])));
  },

  bars(plot, series, sx, sy, [, height]) {
    const bottom = series.y.map((value) => (value > 0 || !sy.base ? sy(value) : height));
    plot.selectAll(null).data(d3.range(series.y.length)).enter().append("rect").attr({
      class: "bar",
      fill: series.color,
      opacity: 0.45,
      stroke: series.color,
      x: (i) => sx(series.edges[i]),
      width: (i) => Math.max(0, sx(series.edges[i + 1]) - sx(series.edges[i])),
      y: (i) => bottom[i],
      height: (i) => Math.max(0, height - bottom[i]),
    });
  },

  points(plot, series, sx, sy, [, height]) {
    const shown = d3.range(series.x.length)
                      .filter(
                          (i) => finite(series.x[i]) && finite(series.y[i]) &&
                              (!sy.base || series.y[i] > 0) && (!sx.base || series.x[i] > 0));
    const end = (value) => (sy.base && value <= 0 ? height : sy(value));
    if (series.sigma) {
      plot.append("path")
          .attr({class: "error", stroke: series.color})
          .attr(
              "d",
              shown.filter((i) => finite(series.sigma[i]))
                      .map(
                          (i) => `M${sx(series.x[i])},${end(series.y[i] - series.sigma[i])}V${
                              end(series.y[i] + series.sigma[i])}`)
                      .join("") ||
                  null);
    }
    const mark = d3.svg.symbol().type(series.symbol ?? "circle").size(34);
    const points = plot.selectAll(null).data(shown).enter().append("path").attr({
      class: (i) => (series.hollow?.[i] ? "point hollow" : "point"),
      d: mark,
      stroke: series.color,
      fill: (i) => (series.hollow?.[i] ? null : series.color),
      transform: (i) => `translate(${sx(series.x[i])},${sy(series.y[i])})`,
    });
    if (series.note) points.append("title").text(series.note);
  },
};

/** Ticks at decades, and at 2 and 5 if there are few decades. */
function logTicks([least, greatest]) {
  const decades = Math.log10(greatest / least);
  const steps = decades > 6 ? [1] : decades > 2.5 ? [1] : decades > 1.2 ? [1, 3] : [1, 2, 5];
  const ticks = [];
  for (let power = Math.floor(Math.log10(least)); power <= Math.log10(greatest); ++power) {
    for (const step of steps) {
      const value = step * 10 ** power;
      if (value >= least && value <= greatest) ticks.push(value);
    }
  }
  return ticks;
}

function tickText(value) {
  const power = Math.round(Math.log10(value) * 1e6) / 1e6;
  if (value >= 0.0099 && value < 10001) return String(Number(value.toPrecision(3)));
  const lead = Math.round(value / 10 ** Math.floor(power));
  return `${lead === 1 ? "" : `${lead}·`}10${raised(Math.floor(power))}`;
}
