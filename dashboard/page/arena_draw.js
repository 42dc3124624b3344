// Draws light, trails and robots on three canvases, each of which is redrawn only when it changes.
// The arena looks the same in the light and the dark theme, because its brightness shows the light.

import {FLAG} from "./arena.js";
import {allPrograms, programAt} from "./programs.js";

const FLOOR = [24, 26, 30];
const WHITE = [238, 234, 222];
const RED = "#FF3B30";
const CONTACT = "#F0E442";
export const ORIGIN_DASH = {
  1: [],
  2: [5, 3],
  3: [1.5, 3]
};

/** The raster of the light as a small picture. @param bytes the top row first */
export function lightPicture(bytes, columns, rows) {
  const canvas = new OffscreenCanvas(columns, rows);
  const context = canvas.getContext("2d");
  const image = context.createImageData(columns, rows);
  for (let i = 0; i < columns * rows; ++i) {
    const share = bytes[i] / 255;
    for (let c = 0; c < 3; ++c) image.data[4 * i + c] = FLOOR[c] + share * (WHITE[c] - FLOOR[c]);
    image.data[4 * i + 3] = 255;
  }
  context.putImageData(image, 0, 0);
  return canvas.transferToImageBitmap();
}

export function drawUnder(context, view, arena, picture) {
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.fillStyle = "#0b0c0e";
  context.fillRect(0, 0, context.canvas.width, context.canvas.height);
  const [left, top] = [view.px(0), view.py(arena.height)];
  const [width, height] = [arena.width * view.scale, arena.height * view.scale];
  context.fillStyle = `rgb(${FLOOR.join(" ")})`;
  context.fillRect(left, top, width, height);
  if (picture) context.drawImage(picture, left, top, width, height);
  context.strokeStyle = "#9aa4ae";
  context.lineWidth = view.ratio;
  context.strokeRect(left, top, width, height);
}

/** One path per program and half minute, so that a hundred robots need only a few strokes. */
export function drawTrails(context, view, arena) {
  context.clearRect(0, 0, context.canvas.width, context.canvas.height);
  context.lineWidth = 1.5 * view.ratio;
  context.lineJoin = "round";
  for (let program = -1; program < allPrograms().length; ++program) {
    for (const young of [false, true]) {
      context.beginPath();
      for (const {trail} of arena.present()) addTrail(context, view, trail, program, young);
      context.globalAlpha = young ? 0.9 : 0.4;
      context.strokeStyle = programAt(program).color;
      context.stroke();
    }
  }
  context.globalAlpha = 1;
}

/**
 * Only each trail's newest piece, onto what is painted: the rest need not be painted anew each
 * time.
 */
export function addToTrails(context, view, arena) {
  for (let program = -1; program < allPrograms().length; ++program) {
    context.beginPath();
    for (const {trail} of arena.present()) addPiece(context, view, trail, program, trail.count - 1);
    context.globalAlpha = 0.9;
    context.strokeStyle = programAt(program).color;
    context.stroke();
  }
  context.globalAlpha = 1;
}

function addTrail(context, view, trail, program, young) {
  const half = Math.floor(trail.count / 2);
  const last = young ? trail.count : half + 1;
  for (let i = young ? half + 1 : 1; i < Math.min(last, trail.count); ++i)
    addPiece(context, view, trail, program, i);
}

function addPiece(context, view, trail, program, i) {
  if (i < 1) return;
  const to = trail.at(i);
  const from = trail.at(i - 1);
  if (trail.program[to] !== program || Number.isNaN(trail.x[to]) || Number.isNaN(trail.x[from]))
    return;
  context.moveTo(view.px(trail.x[from]), view.py(trail.y[from]));
  context.lineTo(view.px(trail.x[to]), view.py(trail.y[to]));
}

/**
 * Pictures made once, by key: what would cost most is to write and to dash a hundred times a
 * picture.
 */
class Stamps {
  #made = new Map();

  get(key, width, height, draw) {
    let stamp = this.#made.get(key);
    if (!stamp) {
      if (this.#made.size > 1000) {
        for (const old of this.#made.values()) old.close();
        this.#made.clear();
      }
      const canvas = new OffscreenCanvas(Math.ceil(width), Math.ceil(height));
      draw(canvas.getContext("2d"));
      stamp = canvas.transferToImageBitmap();
      this.#made.set(key, stamp);
    }
    return stamp;
  }
}

const labels = new Stamps();
const bodies = new Stamps();

function label(text, ratio) {
  const size = Math.round(11 * ratio);
  return labels.get(`${text} ${ratio}`, size * (text.length * 0.7 + 1), 1.5 * size, (context) => {
    context.font = `${size}px "Liberation Sans", sans-serif`;
    context.textBaseline = "middle";
    context.lineWidth = 3 * ratio;
    context.lineJoin = "round";
    context.strokeStyle = "#0b0c0e";
    context.strokeText(text, 3 * ratio, 0.75 * size);
    context.fillStyle = "#fff";
    context.fillText(text, 3 * ratio, 0.75 * size);
  });
}

/** A robot without its heading, in the middle of a square. */
function body(look, radius, ratio) {
  const half = Math.ceil(radius * 1.5 + 12 * ratio);
  const stopped = look.flags & FLAG.stopped;
  const key = [
    look.program, look.origin, stopped, look.contact, look.chosen, radius, ratio,
    programAt(look.program).letter
  ].join();
  return bodies.get(key, 2 * half, 2 * half, (context) => {
    const program = programAt(look.program);
    context.translate(half, half);
    if (look.contact) ring(context, radius + 4 * ratio, 3 * ratio, CONTACT);
    if (look.chosen) ring(context, radius + 7 * ratio, 2 * ratio, "#fff");
    context.beginPath();
    context.arc(0, 0, radius, 0, 2 * Math.PI);
    context.fillStyle = program.color;
    context.fill();
    ring(context, radius, 3 * ratio, "#fff");
    context.setLineDash((ORIGIN_DASH[look.origin] ?? []).map((part) => part * ratio));
    ring(context, radius, 1.6 * ratio, "#000");
    if (program.letter && radius > 5 * ratio) {
      context.fillStyle = program.ink;
      context.font = `bold ${Math.round(radius * 1.05)}px "Liberation Sans", sans-serif`;
      context.textAlign = "center";
      context.textBaseline = "middle";
      context.fillText(program.letter, 0, radius * 0.06);
    }
    if (stopped) {
      context.fillStyle = RED;
      context.fillRect(-radius * 0.5, -radius * 1.5, radius, radius * 0.45);
    }
  });
}

function strokeNoses(context, noses, ratio) {
  for (const [color, width] of [["#000", 3.5], ["#fff", 1.8]]) {
    context.lineWidth = width * ratio;
    context.strokeStyle = color;
    context.stroke(noses);
  }
}

/** The heading, drawn as a nose beyond the rim. */
function addNose(noses, x, y, angle, radius) {
  const [c, s] = [Math.cos(angle), -Math.sin(angle)];
  noses.moveTo(x + 0.55 * radius * c, y + 0.55 * radius * s);
  noses.lineTo(x + 1.35 * radius * c, y + 1.35 * radius * s);
}

/** Draws one robot. `look`: {program, origin, flags, contact, reversed, chosen}. */
export function drawRobot(context, x, y, angle, radius, ratio, look) {
  const stamp = body(look, radius, ratio);
  context.drawImage(stamp, Math.round(x - stamp.width / 2), Math.round(y - stamp.height / 2));
  if (look.reversed) chevrons(context, x, y, angle, radius, ratio);
}

/** Draws it with its heading, for the legend. */
export function drawSample(context, x, y, radius, ratio, look) {
  const noses = new Path2D();
  drawRobot(context, x, y, 0, radius, ratio, look);
  addNose(noses, x, y, 0, radius);
  strokeNoses(context, noses, ratio);
}

function ring(context, radius, width, color) {
  context.beginPath();
  context.arc(0, 0, radius, 0, 2 * Math.PI);
  context.lineWidth = width;
  context.strokeStyle = color;
  context.stroke();
}

function chevrons(context, x, y, angle, radius, ratio) {
  context.setTransform(1, 0, 0, 1, x, y);
  context.rotate(-angle);
  context.beginPath();
  for (const at of [1.25, 1.6]) {
    context.moveTo(-radius * at + radius * 0.25, -radius * 0.35);
    context.lineTo(-radius * at, 0);
    context.lineTo(-radius * at + radius * 0.25, radius * 0.35);
  }
  context.lineWidth = 2 * ratio;
  context.strokeStyle = "#fff";
  context.stroke();
  context.setTransform(1, 0, 0, 1, 0, 0);
}

export function drawRobots(context, view, arena, now, {chosen, ids}) {
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.clearRect(0, 0, context.canvas.width, context.canvas.height);
  const radius = Math.round(2 * arena.radius * view.scale) / 2;
  const place = {};
  const noses = new Path2D();
  for (const [x, y] of arena.unidentified)
    cross(context, view.px(x), view.py(y), radius * 0.7, view.ratio);
  const last = (robot) => robot.id === chosen;  // drawn above the others
  for (const robot of [...arena.present()].sort((a, b) => last(a) - last(b))) {
    arena.pose(robot, now, place);
    const [x, y] = [view.px(place.x), view.py(place.y)];
    drawRobot(context, x, y, place.a, radius, view.ratio, {
      program: robot.program,
      origin: robot.origin,
      flags: robot.flags,
      contact: now < robot.contactUntil,
      reversed: now < robot.reversedUntil,
      chosen: robot.id === chosen,
    });
    addNose(noses, x, y, place.a, radius);
    if (robot.sigma * view.scale > view.ratio) {
      context.setTransform(1, 0, 0, 1, x, y);
      ring(context, robot.sigma * view.scale, view.ratio, "#56B4E9");
      context.setTransform(1, 0, 0, 1, 0, 0);
    }
    if (ids)
      context.drawImage(
          label(String(robot.id), view.ratio), Math.round(x + radius * 0.8),
          Math.round(y - radius * 0.8 - 14 * view.ratio));
  }
  strokeNoses(context, noses, view.ratio);
  scaleBar(context, view);
}

export function cross(context, x, y, size, ratio) {
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.beginPath();
  context.moveTo(x - size, y - size);
  context.lineTo(x + size, y + size);
  context.moveTo(x - size, y + size);
  context.lineTo(x + size, y - size);
  context.lineWidth = 2 * ratio;
  context.strokeStyle = "#B8B8B8";
  context.stroke();
}

function scaleBar(context, view) {
  const wanted = (90 * view.ratio) / view.scale;
  const decade = 10 ** Math.floor(Math.log10(wanted));
  const length = [5, 2, 1].map((m) => m * decade).find((cm) => cm <= wanted) ?? decade;
  const [left, bottom] = [14 * view.ratio, context.canvas.height - 14 * view.ratio];
  for (const [color, width] of [["#000", 5], ["#fff", 2]]) {
    context.beginPath();
    context.moveTo(left, bottom);
    context.lineTo(left + length * view.scale, bottom);
    context.lineWidth = width * view.ratio;
    context.strokeStyle = color;
    context.stroke();
  }
  context.drawImage(label(`${length} cm`, view.ratio), left, bottom - 20 * view.ratio);
}
