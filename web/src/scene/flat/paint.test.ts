import { expect, test } from "vitest";
import { coloursOf, extraColour } from "./colours";
import { type Picture, paint } from "./paint";
import { NOTHING, told } from "./world";

type Call = [string, ...unknown[]];

/** A canvas that writes down what is drawn, and in which colour and strength. */
function canvas() {
  const calls: Call[] = [];
  const state: { [name: string]: unknown; fillStyle: string; globalAlpha: number } = {
    fillStyle: "",
    globalAlpha: 1,
  };
  const context = new Proxy(state, {
    get: (_, name: string) =>
      name in state
        ? state[name]
        : (...given: unknown[]) =>
            calls.push([name, ...given, { fill: state.fillStyle, alpha: state.globalAlpha }]),
    set: (_, name: string, value) => {
      state[name] = value;
      return true;
    },
  });
  const drawn = (name: string) => calls.filter(([called]) => called === name);
  return { context: context as unknown as CanvasRenderingContext2D, drawn };
}

const all = {
  map: true,
  local_map: true,
  path: true,
  scan: true,
  robot: true,
  goal: true,
  trail: true,
  places: true,
  zones: true,
};
const picture: Picture = {
  size: { width: 200, height: 100 },
  camera: { x: 0, y: 0, scale: 10 },
  colours: coloursOf("light"),
  layers: all,
  world: NOTHING,
  cells: null,
  robot: null,
  considered: null,
  places: [],
  zones: [],
  sketch: [],
  measured: [],
  old: false,
};
const scan = [1, 2, -3, 0];

test("what is in the way of the goal is crossed out where it is, with the layer of the goal", () => {
  const world = { ...NOTHING, hindrance: { x: 2, y: 1 } };
  const shown = canvas();
  paint(shown.context, { ...picture, world });
  const ends = shown.drawn("lineTo").map(([, x, y]) => [x, y] as [number, number]);
  expect(ends.length).toBeGreaterThan(0);
  for (const [x, y] of ends) expect(Math.hypot(x - 120, y - 40)).toBeLessThan(20);
  const hidden = canvas();
  paint(hidden.context, { ...picture, layers: { ...all, goal: false }, world });
  expect(hidden.drawn("lineTo")).toEqual([]);
});

test("the scan is drawn where its points are, y up", () => {
  const { context, drawn } = canvas();
  paint(context, { ...picture, world: { ...NOTHING, scan } });
  const [, ...points] = drawn("fillRect");
  expect(
    points.map(([, x, y, side]) => [Number(x) + Number(side) / 2, Number(y) + Number(side) / 2]),
  ).toEqual([
    [110, 30],
    [70, 50],
  ]);
});

test("a layer that is switched off is not drawn", () => {
  const { context, drawn } = canvas();
  const world = { ...NOTHING, scan, goal: { x: 0, y: 0, yaw: null }, path: [0, 0, 1, 1] };
  const off = Object.fromEntries(Object.keys(all).map((key) => [key, false])) as typeof all;
  paint(context, { ...picture, world, robot: { x: 0, y: 0, yaw: 0 }, layers: off });
  expect(drawn("fillRect")).toHaveLength(1);
  expect(drawn("stroke")).toHaveLength(0);
  expect(drawn("fill")).toHaveLength(0);
});

test("what is too old to be believed is faint", () => {
  const strength = (old: boolean) => {
    const { context, drawn } = canvas();
    paint(context, { ...picture, world: { ...NOTHING, scan }, old });
    return drawn("fillRect")[1]?.at(-1);
  };
  expect(strength(false)).toMatchObject({ alpha: 1 });
  expect(strength(true)).toMatchObject({ alpha: 0.35 });
});

test("the robot's front points where it is heading, and a small robot is seen all the same", () => {
  const { context, drawn } = canvas();
  paint(context, { ...picture, robot: { x: 2, y: 1, yaw: 0.5 } });
  expect(drawn("translate")[0]?.slice(1, 3)).toEqual([120, 40]);
  expect(drawn("rotate")[0]?.[1]).toBe(-0.5);
  expect(Number(drawn("scale")[0]?.[1]) * 0.11).toBeGreaterThanOrEqual(8);
});

test("a refused place is crossed out, and the nearest one has a ring", () => {
  const { context, drawn } = canvas();
  const considered = { mark: { x: 1, y: 0, yaw: null }, way: [], refused: { x: 0, y: 0 } };
  paint(context, { ...picture, considered });
  expect(drawn("arc")[0]?.slice(1, 3)).toEqual([110, 50]);
  expect(drawn("moveTo").map(([, x, y]) => [x, y])).toContainEqual([90, 40]);
});

test("a place is a ring, a stroke for its heading and its name, unless its layer is off", () => {
  const places = [{ name: "Dock", x: 1, y: 0, yaw: Math.PI / 2 }];
  const { context, drawn } = canvas();
  paint(context, { ...picture, places });
  expect(drawn("arc")[0]?.slice(1, 3)).toEqual([110, 50]);
  expect(drawn("fillText")[0]?.slice(1, 3)).toEqual(["Dock", 110]);
  const [, x, y] = drawn("lineTo")[0] ?? [];
  expect(x).toBeCloseTo(110);
  expect(y).toBe(36); // to the north, and the name is above that
  expect(Number(drawn("fillText")[0]?.[3])).toBeLessThan(36);
  const off = canvas();
  paint(off.context, { ...picture, places, layers: { ...all, places: false } });
  expect(off.drawn("fillText")).toHaveLength(0);
});

test("news change what they name, and nothing else", () => {
  const world = told({ ...NOTHING, scan, path: [1, 1] }, { type: "map", scan: null, trail: [] });
  expect(world).toMatchObject({ scan: null, path: [1, 1], trail: [], map: null });
});

test("a further topic is drawn in the colour that it has in the list of layers, and then no more", () => {
  const shape = {
    points: [1, 2],
    lines: [0, 0, 1, 0],
    areas: [0, 0, 1, 0, 1, 1, 0, 1],
    texts: [{ x: 0, y: 1, text: "here" }],
  };
  const world = told(NOTHING, { extras: { "/other/plan": shape } });
  const shown = canvas();
  paint(shown.context, { ...picture, world });
  const colour = extraColour("/other/plan", coloursOf("light"));
  const dots = shown.drawn("fillRect").filter((call) => call[1] === 108.5 && call[2] === 28.5);
  expect(dots.map((call) => call[5])).toEqual([{ fill: colour, alpha: 1 }]);
  expect(shown.drawn("fill").map((call) => call[1])).toContainEqual({ fill: colour, alpha: 0.5 });
  expect(shown.drawn("fillText")[0]?.[1]).toBe("here");
  expect(told(world, { path: [0, 0, 1, 1] }).extras).toEqual({ "/other/plan": shape });
  expect(told(world, { extras: { "/other/plan": null } }).extras).toEqual({});
});
