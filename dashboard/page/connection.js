// Shows whether the page receives data from the server and the server from the lab.

import {find, setText} from "./dom.js";
import {seconds} from "./format.js";

const PULSE_MS = 3000;
const BUS_S = 2;

export class Connection {
  constructor(stream) {
    const began = performance.now();
    const show = () => {
      const silent = performance.now() - (stream.lastPulse || began);
      // null: no message has come from a lab yet.
      const pulse = stream.topics.get("pulse");
      const bus = pulse ? pulse.bus_silent_s ?? Infinity : 0;
      const [level, text, short] = state(stream, silent, bus);
      const banner = find("banner");
      banner.hidden = !text;
      banner.dataset.level = level;
      setText(banner, text);
      setText(find("link-text"), short);
      find("link-lamp").dataset.state = level;
      document.body.classList.toggle(
          "no-lab", !isLab(stream.topics) && bus > BUS_S && stream.lastPulse > 0);
    };
    setInterval(show, 250);
    stream.on("pulse", show);
    stream.on("lab", (lab) => {
      if (isLab(stream.topics)) document.title = `${lab.name || lab.run} - Active Lab`;
      setText(find("run-name"), lab.run || lab.name || "Active Lab");
      setText(find("run-text"), lab.description ?? "");
      setText(find("version"), lab.version ?? "");
    });
  }
}

/** Whether a lab is known. Before, the server sends the topic without names, for the default arena. */
function isLab(topics) {
  const lab = topics.get("lab");
  return Boolean(lab?.run || lab?.name);
}

/** @return [level, banner, short] */
function state(stream, silent, bus) {
  const topics = stream.topics;
  const ended = topics.get("script")?.phase === "ended" || topics.get("timeline")?.end;
  if (ended && !topics.has("player")) {
    const why = topics.get("timeline")?.end?.text;
    const folder = topics.get("lab")?.run ?? "";
    const next = "lab web shows it here, lab run FILE starts another run.";
    const text = `the run has ended${why ? `: ${why}` : ""}.`;
    return [
      "ended", `${text} Its report is in the run's folder ${folder}; ${next}`, "run has ended"
    ];
  }
  if (silent > PULSE_MS) {
    const since = new Date(Date.now() - silent).toLocaleTimeString([], {hour12: false});
    const heard = stream.lastPulse ?
        `no message from the server since ${since}, connecting again; this page shows old data` :
        "no message from the server yet, connecting again";
    return ["bad", heard, "no server"];
  }
  if (bus > BUS_S && !isLab(topics)) return ["quiet", "", "no lab is running"];
  if (bus === Infinity) return ["quiet", "", "waiting for the lab"];
  if (bus > BUS_S) {
    const next = "lab spy lists the senders on the bus, lab doctor checks this host";
    const text = `no message from the lab for ${seconds(bus)}: this page shows old data. ${next}`;
    return ["bad", text, "lab is silent"];
  }
  return ["good", "", isLab(topics) ? "live" : "connected"];
}
