// The timeline of the run: past and planned steps, delays of the light, marks, faults and the
// remaining time.

import {drawWhenSeen, el, fillTable, find, setText} from "./dom.js";
import {DASH, seconds, stopwatch, timeOfDay} from "./format.js";

const d3 = window.d3;
const HEIGHT = 92;
const BAR = {
  top: 26,
  height: 26
};
const MOST_EVENTS = 30;
const MOST_STEPS = 12;

const after = (us, from) => (us > 0 && from > 0 ? seconds((us - from) / 1e6) : DASH);
const STEP_COLUMNS = [
  {head: "step", right: true, text: (s) => String(s.number)},
  {head: "label", text: (s) => s.label},
  {head: "commanded", text: (s) => timeOfDay(s.commanded_us)},
  {head: "presented after", right: true, text: (s) => after(s.presented_us, s.commanded_us)},
  {head: "seen by camera after", right: true, text: (s) => after(s.seen_us, s.commanded_us)},
  {head: "first robot after", right: true, text: (s) => after(s.first_acted_us, s.commanded_us)},
  {head: "last robot after", right: true, text: (s) => after(s.last_acted_us, s.commanded_us)},
  {
    head: "robots",
    right: true,
    text: (s) => `${s.robots_acted ?? DASH} of ${s.robots_expected ?? DASH}`,
    kind: (s) => (s.robots_acted < s.robots_expected ? "warn" : "")
  },
  {head: "previous step ended by", text: (s) => s.ended_by || "time"},
];
const DELAY_COLUMNS = [
  {head: "delay until", text: (d) => d.until},
  {head: "steps", right: true, text: (d) => String(d.count)},
  {head: "median", right: true, text: (d) => seconds(d.p50_s)},
  {head: "95 %", right: true, text: (d) => seconds(d.p95_s)},
  {head: "99 %", right: true, text: (d) => seconds(d.p99_s)},
  {head: "longest", right: true, text: (d) => seconds(d.max_s)},
];

export class Timeline {
  #stream;
  #holder = find("timeline");
  #svg;

  constructor(stream) {
    this.#stream = stream;
    this.#holder.className = "chart";
    this.#svg = d3.select(this.#holder).append("svg").attr({role: "img", height: HEIGHT});
    const mark = drawWhenSeen(this.#holder, () => this.#draw());
    new ResizeObserver(mark).observe(this.#holder);
    stream.on(
        "timeline",
        (timeline) => {
          this.#tables(timeline);
          mark();
        },
        () => {
          this.#tables({});
          mark();
        });
    stream.on("lab", mark);
    stream.on(
        "delivery", (delivery) => fillTable(find("delivery"), DELAY_COLUMNS, delivery.delays ?? []),
        () => fillTable(find("delivery"), DELAY_COLUMNS, []));
    stream.on("script", (script) => {
      this.#words(script);
      mark();
    });
  }

  #tables(timeline) {
    const newest = [...(timeline.steps ?? [])].reverse();
    fillTable(find("steps"), STEP_COLUMNS, newest.slice(0, MOST_STEPS));
    const told = [
      ...(timeline.faults ?? []).map((fault) => ({...fault, fault: true})),
      ...(timeline.marks ?? [])
    ].sort((a, b) => b.t_us - a.t_us);
    if (timeline.end) told.unshift(timeline.end);
    find("events").replaceChildren(
        ...told.slice(0, MOST_EVENTS)
            .map(
                (event) =>
                    el("li", {}, el("span", {class: "quiet", text: `${timeOfDay(event.t_us)} `}),
                       event.fault ? el("span", {class: "bad", text: "fault: "}) : null,
                       event.text ?? "")));
    const earlier = (all, most, before) =>
        Math.max(0, all.length - most) + before.reduce((sum, key) => sum + (timeline[key] ?? 0), 0);
    const steps = earlier(newest, MOST_STEPS, ["steps_before"]);
    const events = earlier(told, MOST_EVENTS, ["marks_before", "faults_before"]);
    const more = [
      ...(steps ? [`${steps} earlier steps`] : []),
      ...(events ? [`${events} earlier marks and faults`] : [])
    ];
    setText(find("timeline-more"), more.length ? `not listed: ${more.join(", ")}` : "");
  }

  #words(script) {
    const replay = this.#stream.topics.get("lab")?.replay;
    const phases = {
      preparing: "preparing",
      script: replay ? "played" : "running",
      paused: replay ? "playback paused" : "PAUSED",
      leaving: "ending: the robots are being stopped",
      ended: "the run has ended"
    };
    const step = script.step >= 0 ? `, step ${script.step}: ${script.label}` : "";
    setText(
        find("script-now"),
        `${phases[script.phase] ?? script.phase ?? DASH}${script.phase === "ended" ? "" : step}`);
    const next = typeof script.step_left_s === "number" ?
        `; next step in ${stopwatch(script.step_left_s)}` :
        "";
    setText(
        find("script-left"),
        script.phase === "ended" ?
            "" :
            `${stopwatch(script.elapsed_s)} elapsed, ${script.at_most ? "at most " : ""}` +
                `${stopwatch(script.left_s)} left${next}`);
    setText(find("script-stop"), script.stop ? `ends when: ${script.stop}` : "");
  }

  #draw() {
    const {topics} = this.#stream;
    const [lab, timeline, script] = ["lab", "timeline", "script"].map((topic) => topics.get(topic));
    const width = Math.max(240, this.#holder.clientWidth);
    this.#svg.attr("width", width).selectAll("*").remove();
    if (!timeline?.start_us) {
      this.#svg.append("text")
          .attr({x: 8, y: 40, class: "quiet-text"})
          .text("no experiment has started yet");
      return;
    }
    const since = (us) => (us - timeline.start_us) / 1e6;
    const frame = topics.get("frame");
    const now = timeline.end ? since(timeline.end.t_us) :
                               Math.max(script?.elapsed_s ?? 0, frame ? since(frame.t_us) : 0);
    const planned = lab?.script ?? [];
    const total = Math.max(now + (timeline.end ? 0 : script?.left_s ?? 0), lab?.duration_s ?? 0, 1);
    const sx = d3.scale.linear().domain([0, total]).range([18, width - 30]);
    this.#svg.attr("aria-label", `time line of ${stopwatch(total)}, now at ${stopwatch(now)}`);
    const done = timeline.steps ?? [];
    // Planned steps follow the steps that have really happened.
    const shift = done.length ? since(done[done.length - 1].commanded_us) -
            (planned[done[done.length - 1].number]?.at_s ?? 0) :
                                0;
    const bars = done.map((step, i) => ({
                            from: since(step.commanded_us),
                            to: i + 1 < done.length ? since(done[i + 1].commanded_us) : null,
                            label: step.label,
                            done: true,
                            step
                          }));
    const ahead = done.length ? planned.slice(done[done.length - 1].number + 1) : planned;
    if (!timeline.end)
      for (const step of ahead.slice(0, 400))
        bars.push({from: step.at_s + shift, to: null, label: step.label, done: false});
    bars.forEach((bar, i) => {
      bar.to = Math.min(total, bar.to ?? bars[i + 1]?.from ?? (timeline.end ? now : total));
    });
    for (const bar of bars) this.#bar(bar, sx, since);
    this.#marks(timeline, sx, since);
    this.#svg.append("line").attr(
        {class: "now", x1: sx(now), x2: sx(now), y1: 14, y2: BAR.top + BAR.height + 10});
    this.#svg.append("text")
        .attr({x: Math.min(width - 30, Math.max(20, sx(now))), y: 11, "text-anchor": "middle"})
        .text(timeline.end ? "end" : "now");
    this.#svg.append("g")
        .attr({class: "axis", transform: `translate(0,${HEIGHT - 26})`})
        .call(d3.svg.axis()
                  .scale(sx)
                  .orient("bottom")
                  .ticks(width / 110)
                  .tickSize(4)
                  .tickFormat(stopwatch));
  }

  #bar(bar, sx, since) {
    const [left, width] = [sx(bar.from), Math.max(1, sx(bar.to) - sx(bar.from))];
    const group = this.#svg.append("g");
    group.append("rect").attr(
        {class: bar.done ? "step-done" : "step", x: left, y: BAR.top, width, height: BAR.height});
    const letters = Math.floor((width - 8) / 6.2);
    if (letters > 1) {
      const text = bar.label.length > letters ? `${bar.label.slice(0, letters - 1)}…` : bar.label;
      group.append("text").attr({x: left + 4, y: BAR.top + 17}).text(text);
    }
    group.append("title").text(
        bar.done ? `${bar.label}: presented after ${
                       after(bar.step.presented_us, bar.step.commanded_us)}, ` +
                `last robot after ${after(bar.step.last_acted_us, bar.step.commanded_us)}` :
                   `${bar.label}, planned`);
    for (const key of bar.done ? ["presented_us", "seen_us", "first_acted_us", "last_acted_us"] :
                                 []) {
      if (!(bar.step[key] > 0)) continue;
      const x = sx(since(bar.step[key]));
      group.append("line").attr({
        class: "line",
        stroke: "currentColor",
        x1: x,
        x2: x,
        y1: BAR.top + BAR.height,
        y2: BAR.top + BAR.height + 6
      });
    }
  }

  #marks(timeline, sx, since) {
    const draw = (events, kind, shape) => {
      for (const event of (events ?? []).slice(-200)) {
        this.#svg.append("path")
            .attr({
              class: kind,
              d: d3.svg.symbol().type(shape).size(50)(),
              transform: `translate(${sx(since(event.t_us))},${BAR.top - 6})`
            })
            .append("title")
            .text(`${timeOfDay(event.t_us)} ${event.text}`);
      }
    };
    draw(timeline.marks, "mark", "diamond");
    draw(timeline.faults, "fault", "triangle-down");
  }
}
