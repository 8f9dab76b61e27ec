/** How far the hand pushes, each from -1 to 1: ahead, round to the left, and aside to the left. */
export interface Push {
  ahead: number;
  round: number;
  aside: number;
}

/** What a robot can do at most; 0 aside where it does not go sideways (m/s, m/s, rad/s). */
export interface Limits {
  vx: number;
  vy: number;
  omega: number;
}

export interface Twist {
  vx: number;
  vy: number;
  omega: number;
}

export const NOTHING: Push = { ahead: 0, round: 0, aside: 0 };

/** Less than this share of a stick is a hand that rests on it, or a stick that is worn out. */
const DEAD_ZONE = 0.15;

/** By place and not by letter: WASD lie together on every keyboard, whatever is printed on them. */
const KEYS: Record<string, Push> = {
  KeyW: { ahead: 1, round: 0, aside: 0 },
  ArrowUp: { ahead: 1, round: 0, aside: 0 },
  KeyS: { ahead: -1, round: 0, aside: 0 },
  ArrowDown: { ahead: -1, round: 0, aside: 0 },
  KeyA: { ahead: 0, round: 1, aside: 0 },
  ArrowLeft: { ahead: 0, round: 1, aside: 0 },
  KeyD: { ahead: 0, round: -1, aside: 0 },
  ArrowRight: { ahead: 0, round: -1, aside: 0 },
  KeyQ: { ahead: 0, round: 0, aside: 1 },
  KeyE: { ahead: 0, round: 0, aside: -1 },
};

export function isDrivingKey(code: string): boolean {
  return code in KEYS;
}

export function keysPush(held: Iterable<string>): Push {
  return sum([...held].map((code) => KEYS[code] ?? NOTHING));
}

/** @param x, y where the thumb is from the middle of the stick, in its radii; y is down. */
export function stickPush(x: number, y: number): Push {
  const [right, down] = withoutDeadZone(x, y);
  return { ahead: -down || 0, round: -right || 0, aside: 0 };
}

/** The left stick of a gamepad drives and turns, the right one slides aside. */
export function padPush(pads: readonly (Pick<Gamepad, "axes" | "connected"> | null)[]): Push {
  return sum(
    pads.map((pad) => {
      if (!pad?.connected) return NOTHING;
      const [x = 0, y = 0, aside = 0] = pad.axes;
      return { ...stickPush(x, y), aside: -withoutDeadZone(aside, 0)[0] || 0 };
    }),
  );
}

export function sum(pushes: readonly Push[]): Push {
  const total = { ...NOTHING };
  for (const push of pushes) {
    total.ahead += push.ahead;
    total.round += push.round;
    total.aside += push.aside;
  }
  return { ahead: clip(total.ahead), round: clip(total.round), aside: clip(total.aside) };
}

export function isNothing(push: Push): boolean {
  return push.ahead === 0 && push.round === 0 && push.aside === 0;
}

/** @param share of what the robot can do that the person allows. */
export function twistOf(push: Push, limits: Limits, share: number): Twist {
  return {
    vx: push.ahead * limits.vx * share,
    vy: push.aside * limits.vy * share,
    omega: push.round * limits.omega * share,
  };
}

/** The rest of the way counts from the edge of the zone, so that the slowest speeds are there. */
function withoutDeadZone(x: number, y: number): [number, number] {
  const reach = Math.hypot(x, y);
  if (!(reach > DEAD_ZONE)) return [0, 0];
  const scale = (Math.min(1, reach) - DEAD_ZONE) / (1 - DEAD_ZONE) / reach;
  return [x * scale, y * scale];
}

function clip(value: number): number {
  return Math.max(-1, Math.min(1, value));
}
