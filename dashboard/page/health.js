// The state of all processes, robots and message streams, and advice about problems.

import {drawWhenSeen, el, fillFacts, fillTable, find, setText} from "./dom.js";
import {DASH, heading, number, plain, seconds} from "./format.js";
import {flagWords, originWord} from "./robot_panel.js";

const MARKS = {
  error: "✖",
  warn: "▲"
};
const LEVELS = {
  error: "bad",
  warn: "warn",
  info: "quiet"
};
const some = (key) => (row) => (row[key] > 0 ? "bad" : "");
const count = (key) =>
    ({head: heading(key), right: true, text: (row) => plain(row[key], key), kind: some(key)});
const fact = (key, right = true) =>
    ({head: heading(key), right, text: (row) => plain(row[key], key)});

const SERVICES = [
  fact("name", false),
  {
    head: "state",
    text: (row) => plain(row.state),
    kind: (row) => (/ok|run|ready/i.test(row.state ?? "") ? "good" : "warn")
  },
  {
    head: "origin",
    text: (row) => (typeof row.origin === "number" ? originWord(row.origin) : plain(row.origin))
  },
  fact("host", false),
  fact("pid"),
  fact("starts"),
  {head: "uptime", right: true, text: (row) => seconds(row.uptime_s)},
  {
    head: "last message",
    right: true,
    text: (row) => `${seconds(row.age_s)} ago`,
    kind: (row) => (row.age_s > 3 ? "bad" : "")
  },
  {head: "CPU (%)", right: true, text: (row) => number(row.cpu_percent, 2)},
  {head: "memory (MB)", right: true, text: (row) => number(row.memory_MB)},
  count("lost"),
  count("decode_errors"),
  fact("last_error", false),
  fact("version", false),
];
const STREAMS = [
  fact("channel", false),
  fact("sender", false),
  {head: "rate (Hz)", right: true, text: (row) => number(row.rate_Hz)},
  {head: "last message", right: true, text: (row) => `${seconds(row.age_s)} ago`},
  fact("received"),
  count("lost"),
];
const ROBOTS = [
  fact("id"),
  {
    head: "origin",
    text: (row) => (typeof row.origin === "number" ? originWord(row.origin) : plain(row.origin))
  },
  fact("owner", false),
  fact("program", false),
  {
    head: "battery (V)",
    right: true,
    text: (row) => number(row.battery_V),
    kind: (row) => (row.battery_low ? "bad" : "")
  },
  fact("link_sent"),
  fact("link_received"),
  count("link_errors"),
  {
    head: "last message",
    right: true,
    text: (row) => `${seconds(row.age_s)} ago`,
    kind: (row) => (row.age_s > 1 ? "bad" : "")
  },
  {head: "light", right: true, text: (row) => number(row.light, 2)},
  fact("reversals"),
  fact("tumbles"),
  {head: "flags", text: (row) => (typeof row.flags === "number" ? flagWords(row.flags) : DASH)},
];

export class Health {
  constructor(stream) {
    const draw = drawWhenSeen(find("health-section"), () => {  // drawn after changes of two topics
      const health = stream.topics.get("health") ?? {};
      fillTable(find("robots"), ROBOTS, stream.topics.get("robots") ?? []);
      fillTable(find("services"), SERVICES, health.services ?? []);
      fillTable(find("streams"), STREAMS, health.streams ?? []);
      const more = health.streams_left_out;
      setText(find("streams-more"), more ? `and ${more} more streams, which are not listed` : "");
      fillTable(
          find("not-understood"), [fact("channel", false), count("messages")],
          health.not_understood ?? []);
      fillTable(find("links"), columnsOf(health.links ?? []), health.links ?? []);
      fillFacts(find("tracker"), factsOf("tracker", health.tracker));
      fillFacts(find("server"), factsOf("server", health.server));
    }, 500);
    stream.on("health", (health) => {
      this.#advise(health.advice ?? []);
      draw();
    }, draw);
    stream.on("robots", draw, draw);
    stream.on("light", (light) => {
      const who = light.manual ? "manual override" : `by ${plain(light.commander)}`;
      find("light-now").textContent =
          `light: ${plain(light.label)}, mean ${number(100 * light.mean, 2)} %, ${who}` +
          `${light.moving ? ", moving" : ""}${light.trouble ? `; problem: ${light.trouble}` : ""}`;
    }, () => setText(find("light-now"), ""));
  }

  #advise(advice) {
    const key = JSON.stringify(advice);
    const holder = find("advice");
    if (holder.key === key) return;
    holder.key = key;
    const order = ["error", "warn", "info"];
    const sorted = [...advice].sort((a, b) => order.indexOf(a.level) - order.indexOf(b.level));
    const lines = sorted.map(({level, what, do: next}) => {
      const text = el("span", {class: LEVELS[level] ?? "", text: `${MARKS[level] ?? "·"} ${what}`});
      return el("li", {}, text, next ? el("div", {class: "quiet", text: `→ ${next}`}) : null);
    });
    if (!lines.length) lines.push(el("li", {class: "good", text: "no problems"}));
    holder.replaceChildren(...lines);
  }
}

/** Columns from the keys of the first row. */
function columnsOf(rows) {
  return Object.keys(rows[0] ?? {}).map((key) => ({
                                          head: heading(key),
                                          right: typeof rows[0][key] === "number",
                                          text: (row) => plain(row[key], key),
                                        }));
}

function factsOf(name, values) {
  return Object.entries(values ?? {}).map(([
                                            key, value
                                          ]) => [`${name}: ${heading(key)}`, plain(value, key)]);
}
