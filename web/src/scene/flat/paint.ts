import type { FlatExtra, View } from "../../api/types";
import { type Camera, type Size, toPicture } from "./camera";
import { type Colours, extraColour } from "./colours";
import type { FlatWorld } from "./world";

export interface Place {
  x: number;
  y: number;
  yaw: number | null;
}

/** A place with a name. */
export interface Named extends Place {
  name: string;
}

/** A zone: hatched where the robot keeps out. */
export interface DrawnZone {
  label: string;
  barred: boolean;
  corners: readonly (readonly [number, number])[];
}

/** A goal that is thought about: where and by which way, or where not. */
export interface Considered {
  mark: Place | null;
  way: readonly number[];
  refused: { x: number; y: number } | null;
}

export interface Picture {
  size: Size;
  camera: Camera;
  colours: Colours;
  layers: View["layers"];
  world: FlatWorld;
  /** The map's cells, of the version that `world.map` tells, or of the one before. */
  cells: CanvasImageSource | null;
  robot: Place | null;
  considered: Considered | null;
  places: readonly Named[];
  zones: readonly DrawnZone[];
  sketch: readonly (readonly [number, number])[];
  measured: readonly (readonly [number, number])[];
  /** What moves was heard too long ago to be believed. */
  old: boolean;
}

type Canvas = CanvasRenderingContext2D;

/** Sizes of what is no thing on the floor, px. */
const GOAL = 11;
const CROSS = 10;
const PLACE = 4;
const SMALLEST_ROBOT = 9;
const OLD = 0.35;
const RADIUS_M = 0.11;

/** Draws everything anew, in the order of the scene. */
export function paint(canvas: Canvas, picture: Picture): void {
  const {
    size,
    camera,
    colours,
    layers,
    world,
    robot,
    considered,
    places,
    zones,
    sketch,
    measured,
    old,
  } = picture;
  const at = (x: number, y: number) => toPicture(camera, size, [x, y]);
  canvas.fillStyle = colours.floor;
  canvas.fillRect(0, 0, size.width, size.height);
  if (layers.map) cells(canvas, picture);
  if (layers.zones) for (const each of zones) zone(canvas, each, at, colours);
  if (sketch.length > 0) outline(canvas, sketch, at, colours.preview);
  const moving = old ? OLD : 1;
  canvas.globalAlpha = moving;
  if (layers.local_map && world.local_map !== null) {
    const { x, y, yaw, areas } = world.local_map;
    canvas.save();
    inFrame(canvas, at(x, y), yaw, camera.scale);
    canvas.globalAlpha = 0.6 * moving;
    canvas.fillStyle = colours.obstacle;
    for (let i = 0; i + 3 < areas.length; i += 4) {
      const [x0 = 0, y0 = 0, x1 = 0, y1 = 0] = areas.slice(i, i + 4);
      canvas.fillRect(x0, y0, x1 - x0, y1 - y0);
    }
    canvas.restore();
  }
  if (layers.trail) line(canvas, world.trail, at, colours.trail, 2);
  if (layers.path) line(canvas, world.path, at, colours.path, 4);
  if (layers.scan && world.scan !== null) {
    const dot = Math.min(6, Math.max(2, 0.03 * camera.scale));
    canvas.fillStyle = colours.scan;
    for (let i = 0; i + 1 < world.scan.length; i += 2) {
      const [x, y] = at(world.scan[i] ?? 0, world.scan[i + 1] ?? 0);
      canvas.fillRect(x - dot / 2, y - dot / 2, dot, dot);
    }
  }
  for (const [topic, shape] of Object.entries(world.extras)) {
    extra(canvas, shape, at, extraColour(topic, colours), colours, moving);
  }
  canvas.globalAlpha = 1;
  if (layers.places) {
    for (const place of places) named(canvas, place, at(place.x, place.y), colours);
  }
  if (layers.goal && world.goal !== null) goal(canvas, world.goal, at, colours.goal);
  if (layers.goal && world.hindrance !== null) {
    cross(canvas, at(world.hindrance.x, world.hindrance.y), colours);
  }
  if (considered !== null) {
    line(canvas, considered.way, at, colours.preview, 3);
    if (considered.mark !== null) goal(canvas, considered.mark, at, colours.preview);
    if (considered.refused !== null) {
      cross(canvas, at(considered.refused.x, considered.refused.y), colours);
    }
  }
  line(canvas, measured.flat(), at, colours.preview, 3);
  marks(canvas, measured, at, colours.preview);
  if (layers.robot && robot !== null) {
    canvas.globalAlpha = moving;
    body(canvas, robot, picture);
    canvas.globalAlpha = 1;
  }
}

type At = (x: number, y: number) => readonly [number, number];

function zone(canvas: Canvas, { label, barred, corners }: DrawnZone, at: At, colours: Colours) {
  const colour = barred ? colours.alert : colours.slow;
  canvas.save();
  canvas.fillStyle = colour;
  outline(canvas, corners, at, colour);
  canvas.globalAlpha = barred ? 0.25 : 0.12;
  canvas.fill();
  canvas.restore();
  const middle = corners.reduce(([x, y], each) => [x + each[0], y + each[1]], [0, 0]);
  const [x, y] = at(middle[0] / corners.length, middle[1] / corners.length);
  written(canvas, label, [x, y], colours);
}

/** A further topic: areas, lines, points and texts. */
function extra(
  canvas: Canvas,
  { areas, lines, points, texts }: FlatExtra,
  at: At,
  colour: string,
  colours: Colours,
  moving: number,
): void {
  canvas.fillStyle = canvas.strokeStyle = colour;
  canvas.globalAlpha = 0.5 * moving;
  for (let i = 0; i + 7 < areas.length; i += 8) {
    canvas.beginPath();
    for (let corner = i; corner < i + 8; corner += 2) {
      canvas.lineTo(...at(areas[corner] ?? 0, areas[corner + 1] ?? 0));
    }
    canvas.fill();
  }
  canvas.globalAlpha = moving;
  canvas.lineWidth = 2;
  canvas.beginPath();
  for (let i = 0; i + 3 < lines.length; i += 4) {
    canvas.moveTo(...at(lines[i] ?? 0, lines[i + 1] ?? 0));
    canvas.lineTo(...at(lines[i + 2] ?? 0, lines[i + 3] ?? 0));
  }
  canvas.stroke();
  for (let i = 0; i + 1 < points.length; i += 2) {
    const [x, y] = at(points[i] ?? 0, points[i + 1] ?? 0);
    canvas.fillRect(x - 1.5, y - 1.5, 3, 3);
  }
  for (const { x, y, text } of texts) written(canvas, text, at(x, y), colours);
}

function outline(canvas: Canvas, corners: DrawnZone["corners"], at: At, colour: string): void {
  canvas.strokeStyle = colour;
  canvas.lineWidth = 2;
  canvas.beginPath();
  for (const [x, y] of corners) canvas.lineTo(...at(x, y));
  canvas.closePath();
  canvas.stroke();
  if (corners.length <= 2) marks(canvas, corners, at, colour);
}

function marks(canvas: Canvas, points: DrawnZone["corners"], at: At, colour: string): void {
  canvas.fillStyle = colour;
  for (const [x, y] of points) {
    const [u, v] = at(x, y);
    canvas.fillRect(u - PLACE, v - PLACE, 2 * PLACE, 2 * PLACE);
  }
}

function cells(canvas: Canvas, { size, camera, world: { map }, cells: image }: Picture): void {
  if (map === null || image === null) return;
  canvas.save();
  inFrame(canvas, toPicture(camera, size, [map.x, map.y]), map.yaw, camera.scale);
  // The picture has north up, and this frame has it down no more: turned over once again.
  canvas.scale(1, -1);
  canvas.imageSmoothingEnabled = camera.scale * map.resolution < 1;
  const [width, height] = [map.width * map.resolution, map.height * map.resolution];
  canvas.drawImage(image, 0, -height, width, height);
  canvas.restore();
}

function body(canvas: Canvas, robot: Place, { size, camera, colours, world }: Picture): void {
  const outline = world.footprint ?? [];
  const radius = outline.length === 0 ? RADIUS_M : farthest(outline);
  const [x, y] = toPicture(camera, size, [robot.x, robot.y]);
  canvas.save();
  // A robot that is a speck on a large map is drawn larger, so that its front is seen.
  inFrame(canvas, [x, y], robot.yaw ?? 0, Math.max(camera.scale, SMALLEST_ROBOT / radius));
  canvas.beginPath();
  if (outline.length === 0) canvas.arc(0, 0, radius, 0, 2 * Math.PI);
  for (let i = 0; i + 1 < outline.length; i += 2)
    canvas.lineTo(outline[i] ?? 0, outline[i + 1] ?? 0);
  canvas.closePath();
  canvas.fillStyle = colours.body;
  canvas.fill();
  canvas.beginPath();
  for (const [ahead, left] of [
    [0.74, 0],
    [-0.3, 0.52],
    [-0.05, 0],
    [-0.3, -0.52],
  ] as const) {
    canvas.lineTo(ahead * radius, left * radius);
  }
  canvas.closePath();
  canvas.fillStyle = colours.front;
  canvas.fill();
  canvas.restore();
}

function goal(
  canvas: Canvas,
  place: Place,
  at: (x: number, y: number) => readonly [number, number],
  colour: string,
): void {
  const [x, y] = at(place.x, place.y);
  canvas.strokeStyle = canvas.fillStyle = colour;
  canvas.lineWidth = 3;
  canvas.beginPath();
  canvas.arc(x, y, GOAL, 0, 2 * Math.PI);
  canvas.stroke();
  canvas.beginPath();
  canvas.arc(x, y, GOAL * 0.3, 0, 2 * Math.PI);
  canvas.fill();
  if (place.yaw === null) return;
  canvas.save();
  canvas.translate(x, y);
  canvas.rotate(-place.yaw);
  canvas.beginPath();
  canvas.moveTo(GOAL, 0);
  canvas.lineTo(2.4 * GOAL, 0);
  canvas.stroke();
  canvas.beginPath();
  canvas.moveTo(3.2 * GOAL, 0);
  canvas.lineTo(2.1 * GOAL, 0.7 * GOAL);
  canvas.lineTo(2.1 * GOAL, -0.7 * GOAL);
  canvas.closePath();
  canvas.fill();
  canvas.restore();
}

/** A ring, a stroke for its heading, and its name. */
function named(
  canvas: Canvas,
  { name, yaw }: Named,
  [x, y]: readonly [number, number],
  colours: Colours,
): void {
  canvas.strokeStyle = colours.footprint;
  canvas.lineWidth = 2;
  canvas.beginPath();
  canvas.arc(x, y, 1.5 * PLACE, 0, 2 * Math.PI);
  if (yaw !== null) {
    canvas.moveTo(x, y);
    canvas.lineTo(x + 3.5 * PLACE * Math.cos(yaw), y - 3.5 * PLACE * Math.sin(yaw));
  }
  canvas.stroke();
  written(canvas, name, [x, y - 4 * PLACE], colours);
}

function written(
  canvas: Canvas,
  text: string,
  [x, y]: readonly [number, number],
  colours: Colours,
): void {
  canvas.fillStyle = colours.footprint;
  canvas.font = "13px system-ui, sans-serif";
  canvas.textAlign = "center";
  canvas.lineWidth = 3;
  // Readable on whatever lies below it.
  canvas.strokeStyle = colours.floor;
  canvas.strokeText(text, x, y);
  canvas.fillText(text, x, y);
}

/** What the ring of a goal cannot be taken for. */
function cross(canvas: Canvas, [x, y]: readonly [number, number], colours: Colours): void {
  for (const [width, colour] of [
    [8, colours.front],
    [4, colours.alert],
  ] as const) {
    canvas.lineWidth = width;
    canvas.strokeStyle = colour;
    canvas.beginPath();
    canvas.moveTo(x - CROSS, y - CROSS);
    canvas.lineTo(x + CROSS, y + CROSS);
    canvas.moveTo(x - CROSS, y + CROSS);
    canvas.lineTo(x + CROSS, y - CROSS);
    canvas.stroke();
  }
}

function line(
  canvas: Canvas,
  points: readonly number[] | null,
  at: (x: number, y: number) => readonly [number, number],
  colour: string,
  width: number,
): void {
  if (points === null || points.length < 4) return;
  canvas.strokeStyle = colour;
  canvas.lineWidth = width;
  canvas.lineJoin = canvas.lineCap = "round";
  canvas.beginPath();
  for (let i = 0; i + 1 < points.length; i += 2) {
    canvas.lineTo(...at(points[i] ?? 0, points[i + 1] ?? 0));
  }
  canvas.stroke();
}

/** From here on m of a frame that lies at a pixel of the picture, y up. */
function inFrame(canvas: Canvas, at: readonly [number, number], yaw: number, scale: number): void {
  canvas.translate(...at);
  canvas.rotate(-yaw);
  canvas.scale(scale, -scale);
}

function farthest(points: readonly number[]): number {
  let most = 0;
  for (let i = 0; i + 1 < points.length; i += 2) {
    most = Math.max(most, Math.hypot(points[i] ?? 0, points[i + 1] ?? 0));
  }
  return most > 0 ? most : RADIUS_M;
}
