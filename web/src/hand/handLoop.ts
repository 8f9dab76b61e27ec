import { isDrivingKey, isNothing, keysPush, NOTHING, type Push, sum } from "./push";

/** The robot stands when it has not heard of the hand for 250 ms, the way to it included. */
export const RENEW_MS = 50;

/**
 * What the hand does, from keys, stick and gamepad, told while it lasts.
 *
 * Whatever ends a hold without its end being seen (the window loses the focus, the tab is hidden)
 * is a hand that has let go: what is still held down then counts only when it is pressed anew.
 */
export class HandLoop {
  private readonly keys = new Set<string>();
  private stick = NOTHING;
  private slide = NOTHING;
  /** Until it was seen at rest, a gamepad is one that somebody leans on. */
  private padRests = false;
  private timer: number | undefined;
  private readonly listeners = new Set<() => void>();

  constructor(
    private readonly tell: (push: Push) => void,
    private readonly readPads: () => Push,
  ) {}

  start(): void {
    if (this.timer !== undefined) return;
    this.letGo();
    this.timer = window.setInterval(() => this.tell(this.push()), RENEW_MS);
  }

  stop(): void {
    window.clearInterval(this.timer);
    this.timer = undefined;
    this.letGo();
  }

  /** Called when the hand has let go of everything, so that a drawn stick springs back. */
  onLetGo(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  /** A key went down or up; returns whether it drives. */
  key(code: string, down: boolean): boolean {
    if (!isDrivingKey(code)) return false;
    if (down) this.keys.add(code);
    else this.keys.delete(code);
    this.changed();
    return true;
  }

  moveStick(push: Push): void {
    this.stick = push;
    if (isNothing(push)) this.changed();
  }

  /** @param aside to the left, from -1 to 1. */
  moveAside(aside: number): void {
    this.slide = { ...NOTHING, aside };
    this.changed();
  }

  /** What is held down is seen no more: its end would be told elsewhere. */
  letGoKeys(): void {
    this.keys.clear();
    this.changed();
  }

  /** Everything is let go, at once. */
  letGo(): void {
    this.keys.clear();
    this.stick = this.slide = NOTHING;
    this.padRests = false;
    for (const listener of this.listeners) listener();
    this.changed();
  }

  private changed(): void {
    if (this.timer !== undefined) this.tell(this.push());
  }

  private push(): Push {
    const pads = document.hasFocus() ? this.readPads() : NOTHING;
    if (!document.hasFocus()) this.padRests = false;
    else if (isNothing(pads)) this.padRests = true;
    return sum([keysPush(this.keys), this.stick, this.slide, this.padRests ? pads : NOTHING]);
  }
}
