// Creates all parts of the page.

import {ArenaView} from "./arena_view.js";
import {CameraPicture} from "./camera.js";
import {Campaigns} from "./campaigns.js";
import {Connection} from "./connection.js";
import {Controls} from "./controls.js";
import {Crowd} from "./crowd.js";
import {Curves} from "./curves.js";
import {find} from "./dom.js";
import {Estimates} from "./estimates.js";
import {Health} from "./health.js";
import {listenToKeys} from "./keys.js";
import {Labs} from "./labs.js";
import {Player} from "./player.js";
import {setPrograms} from "./programs.js";
import {RobotPanel} from "./robot_panel.js";
import {Runs} from "./runs.js";
import {Start} from "./start.js";
import {Stream} from "./stream.js";
import {Timeline} from "./timeline.js";

function listenToTheme() {
  const root = document.documentElement;
  const kept = localStorage.getItem("lab-theme");
  if (kept) root.dataset.theme = kept;
  find("theme").addEventListener("click", () => {
    const dark = root.dataset.theme ? root.dataset.theme === "dark" :
                                      matchMedia("(prefers-color-scheme: dark)").matches;
    root.dataset.theme = dark ? "light" : "dark";
    localStorage.setItem("lab-theme", root.dataset.theme);
  });
}

listenToTheme();
const stream = new Stream();
let run = null;
const removeCurves = () => ["pool/", "history/", "runtimes/", "crowd"].forEach((old) => stream.remove(old));
stream.on("lab", (lab) => {
  if (run !== null && run !== lab.run) removeCurves();
  if (!lab.replay) stream.remove("player");
  run = lab.run;
  setPrograms(lab.programs ?? []);
});
let jumps = null;  // number of jumps in a recorded run; curves from before a jump are discarded
stream.on("player", (player) => {
  if (jumps !== null && jumps !== player.jumps) removeCurves();
  jumps = player.jumps;
});
const view = new ArenaView(stream);
const controls = new Controls(stream);
const curves = new Curves(stream);
const crowd = new Crowd(stream, view);
const estimates = new Estimates(stream, curves);
const robot = new RobotPanel(stream, view);
const runs = new Runs(stream);
new Connection(stream);
new Timeline(stream);
new Health(stream);
new Player(stream);
new CameraPicture(stream);
new Start(stream, controls);
new Labs();
new Campaigns(stream);
listenToKeys(view, controls);
stream.run();

/** Access for tests. */
window.labPage = {
  stream,
  view,
  controls,
  get fps() {
    return view.fps;
  },
  get drawMs() {
    return view.drawMs;
  },
  get charts() {
    return {
      ...curves.charts(),
      ...crowd.charts(),
      history: estimates.chart(),
      speed: robot.chart(),
      compare: runs.charts().msd
    };
  },
  robots: () => [...view.arena.present()].map(
      ({id, x, y, angle, program}) => ({id, x, y, angle, program})),
};
