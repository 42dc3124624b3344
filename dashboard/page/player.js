// Controls for playing a recorded run.

import {sendRequest} from "./api.js";
import {find, setText} from "./dom.js";
import {stopwatch} from "./format.js";
import {RunFilm} from "./run_film.js";

export class Player {
  constructor(stream) {
    const [at, go, speed] = ["player-at", "player-go", "player-speed"].map(find);
    let held = 0;  // [ms] until then the user is moving the slider
    let paused = false;
    const film = new RunFilm();
    stream.on(
        "player",
        (player) => {
          find("player").hidden = false;
          film.open(stream.topics.get("lab")?.run ?? null);
          paused = player.paused;
          at.max = String(player.length_s ?? 1);
          if (performance.now() > held) {
            at.value = String(player.at_s ?? 0);
            film.show(player.at_s ?? 0);
          }
          if (document.activeElement !== speed) speed.value = String(player.speed ?? 1);
          setText(go, player.paused ? "play" : "pause");
          setText(
              find("player-text"), `${stopwatch(player.at_s)} of ${stopwatch(player.length_s)}`);
          at.setAttribute("aria-valuetext", find("player-text").textContent);
        },
        () => {
          find("player").hidden = true;
          film.close();
        });
    const send = async (name, fields) => {
      const {ok, error} = await sendRequest(name, fields);
      setText(find("player-say"), ok ? "" : `${name}: ${error}`);
    };
    at.addEventListener("input", () => {
      held = performance.now() + 1500;
      film.show(Number(at.value));
      setText(
          find("player-text"), `${stopwatch(Number(at.value))} of ${stopwatch(Number(at.max))}`);
    });
    at.addEventListener("change", () => {
      held = performance.now() + 800;
      send("seek", {to_s: Number(at.value)});
    });
    go.addEventListener("click", () => send(paused ? "resume" : "pause"));
    speed.addEventListener("change", () => send("speed", {speed: Number(speed.value)}));
  }
}
