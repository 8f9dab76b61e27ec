import { type ReactNode, useEffect } from "react";
import { language } from "./language";
import { t } from "./text";
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
    // Into this Mantine lays its menus and lists; it stands in index.html.
    document.querySelector("[data-portal]")?.setAttribute("aria-label", t("Menus and lists"));
  }, [now]);
  return page();
}
