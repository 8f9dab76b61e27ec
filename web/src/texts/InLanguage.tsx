import { type ReactNode, useEffect } from "react";
import { language } from "./language";
import { units } from "./units";

/**
 * Draws the page anew when its language or its units change, and tells the browser which language
 * it is in.
 *
 * @param page makes the page; nothing of it is remounted, so nothing that was typed is lost
 */
export function InLanguage({ page }: { page: () => ReactNode }) {
  const now = language.use();
  units.use();
  useEffect(() => {
    document.documentElement.lang = now;
  }, [now]);
  return page();
}
