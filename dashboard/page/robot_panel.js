// The selected robot: everything it reports, five times per second, and its speed in the last
// minute.

import {get} from "./api.js";
import {Chart} from "./chart.js";
import {fillFacts, fillSelect, find, pollWhileSeen} from "./dom.js";
import {DASH, heading, number, plain, seconds, unit} from "./format.js";
import {programNamed} from "./programs.js";

const FLAGS = [
  "reversing", "stopped", "lease expired: stopped", "wheel saturated", "tumbling",
  "touches a robot", "touches a wall", "last command rejected"
];
const ORIGINS = ["unknown", "real", "simulated", "recorded"];

export const flagWords = (flags) =>
    FLAGS.filter((_, bit) => flags & (1 << bit)).join(", ") || "none";
export const originWord = (origin) => ORIGINS[origin] ?? String(origin);

/** "slow: v 5 cm/s, ... (phase tumble)" */
function programWords({program, phase}) {
  const known = programNamed(program);
  return `${program ?? "none"}${known.text ? `: ${known.text}` : ""}${
      phase ? ` (phase ${phase})` : ""}`;
}

const pair = (first, second, measure = "") =>
    `${number(first)}, ${number(second)}${measure && ` ${measure}`}`;
const ago = (age) => (age < 0.1 ? "now" : `${seconds(age)} ago`);
const place = ({x_cm: x, y_cm: y, theta_deg: theta, seen_age_s: age}) =>
    (typeof x === "number" ? `${x.toFixed(1)}, ${y?.toFixed(1)} cm, ${theta?.toFixed(0)}°${
                                 age > 1 ? `, ${ago(age)}` : ""}` :
                                           "not detected");

/** The facts of a robot: [name, the JSON keys that they use, text]. */
const FACTS = [
  ["pose", ["x_cm", "y_cm", "theta_deg", "seen_age_s"], place],
  [
    "standard error", ["sigma_cm", "sigma_theta_deg"],
    (r) => `${number(r.sigma_cm, 2)} cm, ${number(r.sigma_theta_deg, 2)}°`
  ],
  ["confidence", ["confidence"], (r) => number(r.confidence, 2)],
  ["state", ["flags"], (r) => (r.flags ? flagWords(r.flags) : "follows its program")],
  ["program", ["program", "phase"], programWords],
  ["program started", ["program_age_s"], (r) => ago(r.program_age_s)],
  [
    "wheels", ["wheel_left_cm_s", "wheel_right_cm_s"],
    (r) => pair(r.wheel_left_cm_s, r.wheel_right_cm_s, "cm/s")
  ],
  [
    "wheels, program", ["program_left_cm_s", "program_right_cm_s"],
    (r) => pair(r.program_left_cm_s, r.program_right_cm_s, "cm/s")
  ],
  ["light front, back", ["light_front", "light_back"], (r) => pair(r.light_front, r.light_back)],
  ["infrared", ["ir"], (r) => plain(r.ir)],
  [
    "reversals", ["reversals", "reversal_age_s"],
    (r) => `${plain(r.reversals)}${r.reversals ? `, last ${ago(r.reversal_age_s)}` : ""}`
  ],
  ["tumbles", ["tumbles"], (r) => plain(r.tumbles)],
  ["time in runs", ["run_time_s"], (r) => seconds(r.run_time_s)],
  ["battery", ["battery_V"], (r) => (r.battery_V ? `${number(r.battery_V)} V` : DASH)],
  [
    "messages", ["link_sent", "link_received", "link_errors"],
    (r) => `${plain(r.link_sent)} sent, ${plain(r.link_received)} received, ` +
        `${plain(r.link_errors)} damaged`
  ],
  [
    "body", ["origin", "owner"],
    (r) => `${typeof r.origin === "number" ? originWord(r.origin) : plain(r.origin)}` +
        `${r.owner ? `, service ${r.owner}` : ""}`
  ],
  ["last message", ["age_s"], (r) => ago(r.age_s)],
  ["serial number", ["uid"], (r) => plain(r.uid)],
  ["light band", ["band"], (r) => (r.band >= 0 ? plain(r.band) : DASH)],
  ["program starts", ["program_epoch"], (r) => plain(r.program_epoch)],
  [
    "last command, stop", ["command_seq", "stop_seq"],
    (r) => `${plain(r.command_seq || null)}, ${plain(r.stop_seq || null)}`
  ],
];
const USED_KEYS = new Set(["id", ...FACTS.flatMap(([, keys]) => keys)]);

/** @param robot its JSON @param low whether its battery is low @return rows for fillFacts */
function factsOf(robot, low) {
  return [
    ...FACTS.filter(([, keys]) => keys.some((key) => key in robot && (key !== "uid" || robot.uid)))
        .map(([name, , text]) => [name, text(robot), name === "battery" && low ? "bad" : ""]),
    ...Object.entries(robot)
        .filter(([key]) => !USED_KEYS.has(key))
        .map(([key, value]) => [heading(key), plain(value, key)])
  ];
}

export class RobotPanel {
  #stream;
  #view;
  #known = new Set();
  #speed = new Chart(find("chart-speed"), {
    title: "Speed",
    x: {label: "time (s)"},
    y: {label: "speed (cm/s)", zero: true},
    empty: "select a robot in the arena"
  });

  constructor(stream, view) {
    this.#stream = stream;
    this.#view = view;
    const choice = find("robot-choice");
    stream.on("robots", (robots) => {
      this.#known = new Set(robots.map((robot) => robot.id));
      fillSelect(
          choice, [["", "none"], ...robots.map((robot) => [String(robot.id), String(robot.id)])]);
      choice.value = view.chosen === null ? "" : String(view.chosen);
    });
    choice.addEventListener(
        "change", () => view.choose(choice.value ? Number(choice.value) : null));
    view.onChoice((id) => {
      choice.value = id === null ? "" : String(id);
      fillFacts(find("robot-facts"), []);
      this.#speed.show([], {columns: [], rows: []});
      this.#loadRobot();
      this.#loadSpeeds();
    });
    pollWhileSeen(find("robot-section"), 200, () => this.#loadRobot());
    pollWhileSeen(find("chart-speed"), 1000, () => this.#loadSpeeds());
  }

  chart = () => this.#speed;

  /** A query for a robot that has not reported would be answered with an error. */
  #isKnown = () =>
      this.#stream.connected && this.#view.chosen !== null && this.#known.has(this.#view.chosen);

  async #loadRobot() {
    const id = this.#view.chosen;
    if (!this.#isKnown()) {
      if (id !== null) fillFacts(find("robot-facts"), [["state", "no status received"]]);
      return;
    }
    const found = await get(`/api/ask/robot?which=${id}`);
    if (id !== this.#view.chosen || !found) return;
    const row = this.#stream.topics.get("robots")?.find((robot) => robot.id === id);
    fillFacts(find("robot-facts"), factsOf(found, row?.battery_low));
  }

  async #loadSpeeds() {
    if (!this.#isKnown()) return;
    const id = this.#view.chosen;
    const found = await get(`/api/ask/speeds?which=${id}`);
    if (id !== this.#view.chosen || !found) return;
    const robot = this.#view.arena.robots.get(id);
    const name = this.#stream.topics.get("lab")?.programs?.[robot?.program]?.name;
    this.#speed.setTitle(`Speed of robot ${id}`);
    this.#speed.show(
        [{kind: "line", color: programNamed(name).color, x: found.t_s, y: found.speed_cm_s}], {
          columns: ["time (s)", "speed (cm/s)"],
          rows: found.t_s.map((t, i) => [t, found.speed_cm_s[i]])
        },
        "means over 0.2 s, last minute");
  }
}
