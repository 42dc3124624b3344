// Positions of the robots, interpolated between frames, and their trails. Independent of drawing
// and of the document.

export const FLAG = {
  reversing: 1,
  stopped: 2,
  lease: 4,
  saturated: 8,
  tumbling: 16,
  robot: 32,
  wall: 64,
  rejected: 128
};
const TRAIL_POINTS = 240;
const TRAIL_STEP_US = 250000;
const FLASH_MS = 400;  // how long an event of a single frame is shown

/**
 * Ring buffer of the last positions: x, y [cm] and the program at that time. NaN breaks the line.
 */
class Trail {
  x = new Float32Array(TRAIL_POINTS);
  y = new Float32Array(TRAIL_POINTS);
  program = new Int8Array(TRAIL_POINTS);
  count = 0;
  #next = 0;

  push(x, y, program) {
    this.x[this.#next] = x;
    this.y[this.#next] = y;
    this.program[this.#next] = program;
    this.#next = (this.#next + 1) % TRAIL_POINTS;
    this.count = Math.min(this.count + 1, TRAIL_POINTS);
  }

  /** The array index of the i-th oldest position. */
  at(i) {
    return (this.#next - this.count + i + TRAIL_POINTS) % TRAIL_POINTS;
  }

  clear() {
    this.count = 0;
    this.#next = 0;
  }
}

export class Arena {
  width = 120;  // [cm]
  height = 90;
  radius = 3.75;
  robots = new Map();
  unidentified = [];
  trailVersion = 0;  // changes when positions were added
  wholeTrails = 0;   // changes when the trails must be drawn again completely
  arrived = -1;      // [ms] when the newest frame arrived, -1: none yet
  t_us = 0;
  frames = 0;
  #interval = 50;  // [ms] between frames, smoothed
  #trailAt = 0;

  takeLab(lab) {
    [this.width, this.height] = lab.arena_cm ?? [120, 90];
    this.radius = (lab.robot_diameter_cm ?? 7.5) / 2;
  }

  /** Removes all robots: another run began, or a recorded run was moved to another time. */
  clear() {
    this.robots.clear();
    this.unidentified = [];
    this.#trailAt = 0;
    this.wholeTrails += 1;
  }

  /** @param now [ms] of the display's clock */
  takeFrame(frame, now) {
    if (frame.t_us < this.t_us - 1e6) this.clear();
    const passed = now - this.arrived;
    if (this.arrived >= 0 && passed < 1000)
      this.#interval += 0.1 * (Math.min(passed, 250) - this.#interval);
    const place = {};
    const trail = Math.abs(frame.t_us - this.#trailAt) >= TRAIL_STEP_US;
    for (const [id, x, y, theta, program, flags, origin, confidence, sigma] of frame.robots) {
      let robot = this.robots.get(id);
      if (!robot) {
        robot = {id, trail: new Trail(), frame: -1, contactUntil: 0, reversedUntil: 0};
        this.robots.set(id, robot);
      }
      const angle = (theta * Math.PI) / 180;
      const kept = robot.frame === this.frames;
      if (kept) this.pose(robot, now, place);
      robot.x0 = kept ? place.x : x;
      robot.y0 = kept ? place.y : y;
      robot.a0 = kept ? place.a : angle;
      Object.assign(
          robot,
          {x, y, angle, theta, program, flags, origin, confidence, sigma, frame: this.frames + 1});
      if (flags & (FLAG.robot | FLAG.wall)) robot.contactUntil = now + FLASH_MS;
      if (flags & FLAG.reversing) robot.reversedUntil = now + FLASH_MS;
      if (trail) {
        if (!kept && robot.trail.count) robot.trail.push(NaN, NaN, program);
        robot.trail.push(x, y, program);
      }
    }
    if (trail) {
      this.#trailAt = frame.t_us;
      this.trailVersion += 1;
    }
    this.unidentified = frame.unidentified ?? [];
    this.arrived = now;
    this.t_us = frame.t_us;
    this.frames += 1;
  }

  /** Replaces the trails by those of the last minute from the server. */
  takeTrails(trails) {
    for (const [id, places] of Object.entries(trails.robots ?? {})) {
      const robot = this.robots.get(Number(id));
      if (!robot) continue;
      robot.trail.clear();
      for (let i = 0; i + 1 < places.length; i += 2) {
        robot.trail.push(places[i] ?? NaN, places[i + 1] ?? NaN, robot.program);
      }
    }
    this.wholeTrails += 1;
  }

  /** The robots of the newest frame. */
  * present() {
    for (const robot of this.robots.values())
      if (robot.frame === this.frames) yield robot;
  }

  /** The displayed pose, interpolated from the previous frame to the newest one. */
  pose(robot, now, out) {
    const share = Math.min(1, Math.max(0, (now - this.arrived) / this.#interval));
    const turn = robot.angle - robot.a0;
    out.x = robot.x0 + share * (robot.x - robot.x0);
    out.y = robot.y0 + share * (robot.y - robot.y0);
    out.a = robot.a0 + share * (turn - 2 * Math.PI * Math.round(turn / (2 * Math.PI)));
    return out;
  }

  /** @return the robot nearest to a point within `reach`; null if there is none */
  nearest(x, y, now, reach) {
    let best = null;
    let least = reach;
    const place = {};
    for (const robot of this.present()) {
      this.pose(robot, now, place);
      const distance = Math.hypot(place.x - x, place.y - y);
      if (distance < least) [best, least] = [robot, distance];
    }
    return best;
  }
}
