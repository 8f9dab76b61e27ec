import type { Mask } from "../api/types";
import { t } from "../texts/text";
import { ruleText } from "./zoneText";

/** The masks of the recipe, each with what it asks; null without any. A mask may have many patches. */
export function masksText(masks: readonly Pick<Mask, "name" | "kind" | "speed">[]): string | null {
  const told = new Set(masks.map((mask) => `${mask.name} (${ruleText(mask)})`));
  return told.size === 0
    ? null
    : t("Masks of the recipe, which stay: {names}.", { names: [...told].join(", ") });
}
