// The film of a recorded run, at the time of the player's slider.

import {get, getBytes} from "./api.js";
import {find, setText} from "./dom.js";
import {stopwatch} from "./format.js";

/** @return the index of the last time that is not after `time`; 0 if all are */
export function pictureAt(times, time) {
  let low = 0;
  let high = times.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle;
    else high = middle;
  }
  return low;
}

export class RunFilm {
  #run = null;    // whose film is asked for or shown
  #times = null;  // [s] of each picture
  #fps = 24;

  /** Shows the film of this run, if it has one. */
  async open(run) {
    if (run === null || run === this.#run) return;
    this.close();
    this.#run = run;
    const runs = await get("/api/runs");
    if (!runs?.some((one) => one.name === run && one.film)) return;
    const path = `/api/runs/${encodeURIComponent(run)}`;
    const facts = await get(`${path}/film_clip.json`);
    if (!Array.isArray(facts?.t_s) || facts.t_s.length === 0) return;
    // As a whole: seeking in it then asks nothing of the server.
    const bytes = await getBytes(`${path}/film.mp4`);
    if (bytes === null || run !== this.#run) return;
    this.#times = facts.t_s;
    this.#fps = facts.fps ?? 24;
    find("player-film-video").src = URL.createObjectURL(new Blob([bytes], {type: "video/mp4"}));
    find("player-film").hidden = false;
  }

  /** Shows the picture at a time of the run [s]. */
  show(time) {
    if (this.#times === null) return;
    const picture = pictureAt(this.#times, time);
    // The middle of the picture: a border belongs to either side of it.
    find("player-film-video").currentTime = (picture + 0.5) / this.#fps;
    setText(find("player-film-text"), `film at ${stopwatch(this.#times[picture])}`);
  }

  close() {
    const video = find("player-film-video");
    if (video.src) URL.revokeObjectURL(video.src);
    video.removeAttribute("src");
    find("player-film").hidden = true;
    this.#run = this.#times = null;
  }
}
