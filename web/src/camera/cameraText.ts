import { ageText, wholeAgeText } from "../format";

/** Seconds without a picture after which that is said, and the last one is greyed. */
export const STALE_S = 3;

/** What the page says of cameras. */
export const CAMERA = {
  open: "Camera",
  openHint: "What the robot's camera sees (C)",
  region: "Camera",
  choose: "Which camera",
  larger: "Larger picture",
  smaller: "Smaller picture",
  close: "Close the camera",
  none: "No camera of this robot shows pictures now.",
  silent: "The camera shows no new picture.",
  waiting: "Waiting for the first picture…",
  alt: (topic: string) => `What ${topic} shows`,
} as const;

/**
 * How old the picture is, or how long there has been none.
 *
 * @param age of the newest picture, s; null before the first one
 * @param waited since somebody looks, s
 */
export function pictureAge(age: number | null, waited: number): { text: string; stale: boolean } {
  const without = age ?? waited;
  if (without > STALE_S) return { text: `No picture for ${wholeAgeText(without)}`, stale: true };
  return { text: age === null ? CAMERA.waiting : `${ageText(age)} old`, stale: false };
}
