import { readKept, writeKept } from "../kept";

/** How this browser tells of what happens. */
export interface NotifySettings {
  sound: boolean;
  /** A message of the browser's own, while the page is not looked at. */
  message: boolean;
  /** Nothing is told between these hours (`HH:MM`, this device's clock); null for never. */
  quiet: { from: string; to: string } | null;
}

export const NOTHING: NotifySettings = { sound: false, message: false, quiet: null };
const KEY = "kompass-notify";
const HOUR = /^([01]\d|2[0-3]):[0-5]\d$/;

/** What this browser keeps; whatever is no setting counts as none. */
export function readSettings(text: string | null = readKept(KEY)): NotifySettings {
  if (text === null) return NOTHING;
  let kept: Partial<NotifySettings> | null;
  try {
    kept = JSON.parse(text);
  } catch {
    return NOTHING;
  }
  if (typeof kept !== "object" || kept === null) return NOTHING;
  const { quiet } = kept;
  const valid = quiet != null && HOUR.test(quiet.from) && HOUR.test(quiet.to);
  return {
    sound: kept.sound === true,
    message: kept.message === true,
    quiet: valid ? { from: quiet.from, to: quiet.to } : null,
  };
}

export function keepSettings(settings: NotifySettings): void {
  writeKept(KEY, JSON.stringify(settings));
}

/** Whether nothing is told now; hours may go over midnight. */
export function isQuiet({ quiet }: NotifySettings, now: Date): boolean {
  if (quiet === null || quiet.from === quiet.to) return false;
  const at = `${String(now.getHours()).padStart(2, "0")}:${String(now.getMinutes()).padStart(2, "0")}`;
  return quiet.from < quiet.to
    ? quiet.from <= at && at < quiet.to
    : quiet.from <= at || at < quiet.to;
}
