import { chosen } from "./chosen";

/** The languages of the page, each by its own name. */
export const LANGUAGES = { en: "English", de: "Deutsch" } as const;
export type Language = keyof typeof LANGUAGES;
export const LANGUAGE_KEYS = Object.keys(LANGUAGES) as Language[];

/** The first of the browser's languages that the page has; English where it has none of them. */
export function languageOf(wanted: readonly string[]): Language {
  for (const tag of wanted) {
    const found = LANGUAGE_KEYS.find((each) => each === tag.split("-")[0]?.toLowerCase());
    if (found !== undefined) return found;
  }
  return "en";
}

/** The language of the page: the browser's until somebody chooses one. */
export const language = chosen("kompass-language", LANGUAGE_KEYS, () =>
  languageOf(navigator.languages),
);

/** For Intl: the browser's own region where it speaks this language, as in `de-AT`. */
export function locale(of: Language = language.get()): string {
  return navigator.languages.find((tag) => tag.split("-")[0]?.toLowerCase() === of) ?? of;
}

/**
 * For `lang` of what stands on the page in English whatever its language is: the robot's own words.
 * It is nothing where the page is in English itself.
 */
export const english = (): "en" | undefined => (language.get() === "en" ? undefined : "en");
