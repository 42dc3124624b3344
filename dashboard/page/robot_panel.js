// The chosen robot: everything it tells, five times a second, and its speed of the last minute.

import {get} from "./api.js";
import {Chart} from "./chart.js";
import {fillFacts, fillSelect, find, pollWhileSeen} from "./dom.js";
import {heading, plain} from "./format.js";
import {programNamed} from "./programs.js";

const FLAGS = [
  "reversing", "stopped", "host silent: standing", "wheel saturated", "tumbling", "touches a robot",
  "touches a wall", "last order refused"
];
const ORIGINS = ["unknown", "real", "simulated", "recorded"];

export const flagWords = (flags) =>
    FLAGS.filter((_, bit) => flags & (1 << bit)).join(", ") || "none";
export const originWord = (origin) => ORIGINS[origin] ?? String(origin);

/** Without the parameters that a program does not have: they are 0. */
const sparse = (values) => Object.fromEntries(Object.entries(values).filter(([, value]) => value));

export class RobotPanel {
  #stream;
  #view;
  #known = new Set();
  #speed = new Chart(find("chart-speed"), {
    title: "Speed",
    x: {label: "time (s)"},
    y: {label: "speed (cm/s)", zero: true},
    empty: "choose a robot in the arena"
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
      this.#askRobot();
      this.#askSpeeds();
    });
    pollWhileSeen(find("robot-section"), 200, () => this.#askRobot());
    pollWhileSeen(find("chart-speed"), 1000, () => this.#askSpeeds());
  }

  chart = () => this.#speed;

  /** Nobody is asked about a robot that is not heard: an answer would be an error. */
  #askable = () =>
      this.#stream.connected && this.#view.chosen !== null && this.#known.has(this.#view.chosen);

  async #askRobot() {
    const id = this.#view.chosen;
    if (!this.#askable()) {
      if (id !== null) fillFacts(find("robot-facts"), [["state", "not heard"]]);
      return;
    }
    const told = await get(`/api/ask/robot?which=${id}`);
    if (id !== this.#view.chosen || !told) return;
    const pose = this.#view.arena.robots.get(id);
    const seen = told.pose ?
        [] :
        pose ?
        [
          ["seen at", `${pose.x.toFixed(1)}, ${pose.y.toFixed(1)} cm, ${pose.theta.toFixed(0)}°`],
          ["confidence", plain(pose.confidence)]
        ] :
        [["seen at", "not seen"]];
    fillFacts(find("robot-facts"), [
      ...seen, ...Object.entries(told).filter(([key]) => key !== "id").map(([key, value]) => {
        if (key === "flags" && typeof value === "number") return ["flags", flagWords(value)];
        if (key === "origin" && typeof value === "number") return ["origin", originWord(value)];
        if (key === "program_running" && value) return ["program running", plain(sparse(value))];
        return [heading(key), plain(value, key)];
      })
    ]);
  }

  async #askSpeeds() {
    if (!this.#askable()) return;
    const id = this.#view.chosen;
    const told = await get(`/api/ask/speeds?which=${id}`);
    if (id !== this.#view.chosen || !told) return;
    const robot = this.#view.arena.robots.get(id);
    const name = this.#stream.topics.get("lab")?.programs?.[robot?.program]?.name;
    this.#speed.setTitle(`Speed of robot ${id}`);
    this.#speed.show(
        [{kind: "line", color: programNamed(name).color, x: told.t_s, y: told.speed_cm_s}], {
          columns: ["time (s)", "speed (cm/s)"],
          rows: told.t_s.map((t, i) => [t, told.speed_cm_s[i]])
        },
        "over 0.2 s, the last minute");
  }
}
