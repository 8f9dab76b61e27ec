import { ageText, wholeAgeText } from "../format";
import { t } from "../texts/text";

/** Seconds without a picture after which that is said, and the last one is greyed. */
export const STALE_S = 3;

/**
 * How old the picture is, or how long there has been none.
 *
 * @param age of the newest picture, s; null before the first one
 * @param waited since somebody looks, s
 */
export function pictureAge(age: number | null, waited: number): { text: string; stale: boolean } {
  const without = age ?? waited;
  if (without > STALE_S)
    return { text: t("No picture for {age}", { age: wholeAgeText(without) }), stale: true };
  return {
    text:
      age === null ? t("Waiting for the first picture…") : t("{age} old", { age: ageText(age) }),
    stale: false,
  };
}
