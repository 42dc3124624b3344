// The arena on the page: its visible part, the selected robot and the times of drawing.

import {get, getBytes} from "./api.js";
import {Arena} from "./arena.js";
import {addToTrails, cross, drawRobots, drawSample, drawTrails, drawUnder, lightPicture} from "./arena_draw.js";
import {el, find, setText} from "./dom.js";
import {allPrograms, programAt} from "./programs.js";

const MARGIN_CM = 3;
const TRAILS_MS = 4000;  // period in which the trails fade by one step
const MOVING_TRAILS_MS = 200;
const LIGHT_AGAIN_MS = 1000;
const GROUND = "#2a2d33";  // background of the samples in the legend

/** Converts from the arena [cm] to the canvas [device pixels]. */
class View {
  scale = 1;
  x = 0;  // the point of the arena in the centre of the canvas [cm]
  y = 0;
  zoom = 1;   // 1: the whole arena is visible
  ratio = 1;  // device pixels per CSS pixel
  width = 1;
  height = 1;
  version = 0;

  px = (x) => this.width / 2 + (x - this.x) * this.scale;
  py = (y) => this.height / 2 - (y - this.y) * this.scale;
  cmX = (px) => this.x + (px - this.width / 2) / this.scale;
  cmY = (py) => this.y - (py - this.height / 2) / this.scale;

  settle(arena) {
    const whole = Math.min(
        this.width / (arena.width + 2 * MARGIN_CM), this.height / (arena.height + 2 * MARGIN_CM));
    this.zoom = Math.min(40, Math.max(1, this.zoom));
    this.scale = whole * this.zoom;
    if (this.zoom === 1) [this.x, this.y] = [arena.width / 2, arena.height / 2];
    this.x = Math.min(arena.width, Math.max(0, this.x));
    this.y = Math.min(arena.height, Math.max(0, this.y));
    this.version += 1;
  }
}

export class ArenaView {
  arena = new Arena();
  chosen = null;  // id
  following = false;
  fps = 0;
  drawMs = 0;  // duration of drawing one frame, smoothed
  pictures = 0;
  #view = new View();
  #holder = find("arena");
  #canvases = ["arena-under", "arena-trails", "arena-over"].map(find);
  #contexts = this.#canvases.map((canvas) => canvas.getContext("2d"));
  #picture = null;
  #painted = {view: -1, picture: undefined};
  #trails = {view: -1, when: -Infinity};
  #light = {version: null, wanted: null, busy: false};
  #listeners = [];
  #pointers = new Map();

  constructor(stream) {
    this.#contexts[0].imageSmoothingEnabled = true;
    new ResizeObserver(() => this.#resize()).observe(this.#holder);
    this.#resize();
    this.#listen();
    let run = null;
    stream.on("lab", (lab) => {
      this.arena.takeLab(lab);
      if (run !== null && run !== lab.run) this.arena.clear();
      run = lab.run;
      this.#resize();
      this.#drawLegend();
    });
    let asked = -1;
    stream.on("frame", (frame) => {
      this.arena.takeFrame(frame, performance.now());
      setText(find("arena-count"), counted(frame));
      if (asked !== stream.attempts) {
        asked = stream.attempts;
        get("/api/ask/trails").then((trails) => trails && this.arena.takeTrails(trails));
      }
    });
    let jumps = null;
    stream.on("player", (player) => {
      if (jumps !== null && jumps !== player.jumps) this.arena.clear();
      jumps = player.jumps;
    });
    stream.on("light", (light) => this.#fetchLight(light));
    document.addEventListener(
        "visibilitychange", () => this.#light.wanted && this.#fetchLight(this.#light.wanted));
    this.#animate();
  }

  /** Calls call(id) when another robot is selected; null if none. */
  onChoice(call) {
    this.#listeners.push(call);
  }

  choose(id) {
    if (id === this.chosen) return;
    this.chosen = id;
    if (id === null)
      this.follow(false);
    else
      this.#announce();
    for (const call of this.#listeners) call(id);
  }

  #announce() {
    setText(
        find("arena-say"),
        this.chosen === null ? "no robot selected" :
                               `robot ${this.chosen} ${this.following ? "followed" : "selected"}`);
  }

  /** Selects the next robot by id; -1: the previous one. */
  chooseNext(step) {
    const ids = [...this.arena.present()].map((robot) => robot.id).sort((a, b) => a - b);
    if (!ids.length) return;
    const at = ids.indexOf(this.chosen);
    this.choose(ids[at < 0 ? 0 : (at + step + ids.length) % ids.length]);
  }

  follow(on) {
    this.following = on && this.chosen !== null;
    find("follow").setAttribute("aria-pressed", String(this.following));
    this.#announce();
    if (this.following && this.#view.zoom < 2) this.zoomBy(3);
  }

  zoomBy(factor, px = this.#view.width / 2, py = this.#view.height / 2) {
    const view = this.#view;
    const [x, y] = [view.cmX(px), view.cmY(py)];
    view.zoom *= factor;
    view.settle(this.arena);
    if (view.zoom > 1) {
      view.x += x - view.cmX(px);
      view.y += y - view.cmY(py);
      view.settle(this.arena);
    }
    this.#canvases[2].parentElement.style.touchAction = view.zoom > 1 ? "none" : "pan-y";
  }

  reset() {
    this.follow(false);
    this.#view.zoom = 1;
    this.zoomBy(1);
  }

  /** For tests: the position of a robot on the page [CSS pixels from the arena's corner]. */
  placeOf(id) {
    const robot = this.arena.robots.get(id);
    if (!robot) return null;
    const place = this.arena.pose(robot, performance.now(), {});
    return [this.#view.px(place.x) / this.#view.ratio, this.#view.py(place.y) / this.#view.ratio];
  }

  zoom() {
    return this.#view.zoom;
  }

  #resize() {
    const view = this.#view;
    view.ratio =
        Math.min(2, devicePixelRatio || 1);  // a finer resolution is not visible, but slower
    view.width = Math.max(1, Math.round(this.#holder.clientWidth * view.ratio));
    view.height = Math.max(1, Math.round(this.#holder.clientHeight * view.ratio));
    for (const canvas of this.#canvases) [canvas.width, canvas.height] = [view.width, view.height];
    view.settle(this.arena);
    this.#trails.when = -Infinity;  // a resized canvas is empty
  }

  async #fetchLight(light) {
    this.#light.wanted = light;
    if (this.#light.busy || document.hidden || light.version === this.#light.version) return;
    this.#light.busy = true;
    const asked = this.#light.wanted;
    const size = (asked.columns || 0) * (asked.rows || 0);
    const bytes = size ? await getBytes("/api/light") : new Uint8Array(0);
    const whole =
        bytes?.length === size;  // else they belong to another light; they are requested again
    if (whole) {
      this.#picture?.close();
      this.#picture = size ? lightPicture(bytes, asked.columns, asked.rows) : null;
      this.#light.version = asked.version;
    }
    this.#light.busy = false;
    if (!whole)
      setTimeout(() => this.#fetchLight(this.#light.wanted), LIGHT_AGAIN_MS);
    else if (this.#light.wanted !== asked)
      this.#fetchLight(this.#light.wanted);
  }

  #animate() {
    let seen = false;
    let running = false;  // not visible: nothing is drawn
    const paint = () => {
      running = seen;
      if (!running) return;
      requestAnimationFrame(paint);
      const now = performance.now();
      this.#paint(now);
      this.drawMs += 0.05 * (performance.now() - now - this.drawMs);
      this.pictures += 1;
    };
    new IntersectionObserver((entries) => {
      seen = entries[entries.length - 1].isIntersecting;
      if (!seen || running) return;
      running = true;
      requestAnimationFrame(paint);
    }).observe(this.#holder);
    let [before, since] = [0, performance.now()];
    setInterval(() => {
      const now = performance.now();
      this.fps = (1000 * (this.pictures - before)) / (now - since);
      [before, since] = [this.pictures, now];
    }, 1000);
  }

  #paint(now) {
    const [view, arena, painted] = [this.#view, this.arena, this.#painted];
    const robot = this.following ? arena.robots.get(this.chosen) : null;
    if (robot) {
      const place = arena.pose(robot, now, {});
      [view.x, view.y] = [place.x, place.y];
      view.settle(arena);
    }
    const moved = painted.view !== view.version;
    if (moved || painted.picture !== this.#picture)
      drawUnder(this.#contexts[0], view, arena, this.#picture);
    this.#paintTrails(now);
    this.#painted = {view: view.version, picture: this.#picture};
    drawRobots(
        this.#contexts[2], view, arena, now, {chosen: this.chosen, ids: find("show-ids").checked});
  }

  /**
   * Trails are many lines: while the view moves the old painting is moved along, and painted anew
   * now and then.
   */
  #paintTrails(now) {
    const [view, arena, painted] = [this.#view, this.arena, this.#trails];
    const shown = find("show-trails").checked;
    const moved = painted.view !== view.version;
    const all = shown !== painted.shown || painted.whole !== arena.wholeTrails ||
        now - painted.when > TRAILS_MS || (moved && now - painted.when > MOVING_TRAILS_MS);
    if (all) {
      if (shown)
        drawTrails(this.#contexts[1], view, arena);
      else
        this.#contexts[1].clearRect(0, 0, view.width, view.height);
      const {version, x, y, scale} = view;
      Object.assign(painted, {
        shown,
        view: version,
        whole: arena.wholeTrails,
        count: arena.trailVersion,
        when: now,
        x,
        y,
        scale
      });
      this.#canvases[1].style.transform = "none";
    } else if (moved) {
      const grown = view.scale / painted.scale;
      const right = (view.width / 2) * (1 - grown) + (painted.x - view.x) * view.scale;
      const down = (view.height / 2) * (1 - grown) + (view.y - painted.y) * view.scale;
      this.#canvases[1].style.transform =
          `translate(${right / view.ratio}px, ${down / view.ratio}px) scale(${grown})`;
    } else if (shown && painted.count !== arena.trailVersion) {
      painted.count = arena.trailVersion;
      addToTrails(this.#contexts[1], view, arena);
    }
  }

  #listen() {
    const holder = this.#holder;
    const at = (event) => {
      const box = holder.getBoundingClientRect();
      return [
        (event.clientX - box.left) * this.#view.ratio, (event.clientY - box.top) * this.#view.ratio
      ];
    };
    holder.addEventListener("wheel", (event) => {
      if (event.deltaY > 0 && this.#view.zoom === 1)
        return;  // fully zoomed out: let the page scroll
      event.preventDefault();
      this.zoomBy(Math.exp(-event.deltaY * 0.0015), ...at(event));
    }, {passive: false});
    let dragged = 0;
    holder.addEventListener("pointerdown", (event) => {
      holder.setPointerCapture(event.pointerId);
      this.#pointers.set(event.pointerId, at(event));
      dragged = 0;
    });
    holder.addEventListener("pointermove", (event) => {
      const before = this.#pointers.get(event.pointerId);
      if (!before) return;
      const now = at(event);
      const others = [...this.#pointers].filter(([id]) => id !== event.pointerId);
      dragged += Math.hypot(now[0] - before[0], now[1] - before[1]);
      this.#pointers.set(event.pointerId, now);
      if (others.length) {
        const other = others[0][1];
        const apart = (p) => Math.max(1, Math.hypot(p[0] - other[0], p[1] - other[1]));
        this.zoomBy(apart(now) / apart(before), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
      } else if (dragged > 5 * this.#view.ratio && this.#view.zoom > 1) {
        this.follow(false);
        this.#view.x -= (now[0] - before[0]) / this.#view.scale;
        this.#view.y += (now[1] - before[1]) / this.#view.scale;
        this.#view.settle(this.arena);
      }
    });
    const release = (event) => {
      const alone = this.#pointers.size === 1;
      if (!this.#pointers.delete(event.pointerId) || event.type === "pointercancel") return;
      if (!alone || dragged > 5 * this.#view.ratio) return;
      const [px, py] = at(event);
      const reach = Math.max(this.arena.radius * 1.3, (14 * this.#view.ratio) / this.#view.scale);
      this.choose(
          this.arena.nearest(this.#view.cmX(px), this.#view.cmY(py), performance.now(), reach)
              ?.id ??
          null);
    };
    holder.addEventListener("pointerup", release);
    holder.addEventListener("pointercancel", release);
    holder.addEventListener("keydown", (event) => {
      const step = {ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1}[event.key];
      if (!step) return;
      event.preventDefault();
      this.chooseNext(step);
    });
    find("zoom-in").addEventListener("click", () => this.zoomBy(1.5));
    find("zoom-out").addEventListener("click", () => this.zoomBy(1 / 1.5));
    find("zoom-reset").addEventListener("click", () => this.reset());
    find("follow").addEventListener("click", () => this.follow(!this.following));
  }

  #drawLegend() {
    const size = 60;
    const sample = (text, draw) => {
      const canvas = el("canvas", {width: size, height: size, "aria-hidden": "true"});
      draw(canvas.getContext("2d"));
      return el("span", {}, canvas, text);
    };
    const robot = (look) => (context) => {
      context.fillStyle = GROUND;
      context.fillRect(0, 0, size, size);
      drawSample(context, size / 2, size / 2, 17, 2, {program: -1, origin: 1, flags: 0, ...look});
    };
    find("legend").replaceChildren(
        ...allPrograms().map(
            (program, place) => sample(programAt(place).name, robot({program: place}))),
        sample("real", robot({origin: 1})), sample("simulated", robot({origin: 2})),
        sample("recorded", robot({origin: 3})), sample("stopped", robot({flags: 2})),
        sample("contact", robot({contact: true})), sample("reversing", robot({reversed: true})),
        sample("not identified", (context) => {
          context.fillStyle = GROUND;
          context.fillRect(0, 0, size, size);
          cross(context, size / 2, size / 2, 14, 2);
        }), el("span", {
          class: "quiet",
          text: "thin blue ring: standard error of the position, if large enough to be visible"
        }));
  }
}

function counted(frame) {
  const unknown = frame.unidentified?.length ?? 0;
  return `${frame.robots.length} robots detected${unknown ? `, ${unknown} not identified` : ""}`;
}
