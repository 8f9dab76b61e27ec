import { SAID } from "./german/said";
import { english, language } from "./language";

/** A sentence with `{parts}`, as it is said in English, and how that is in German. */
interface Pattern {
  matches: RegExp;
  german: string;
}

const fixedSentences = new Map<string, string>();
const patterns: Pattern[] = [];
for (const [english_, german] of Object.entries(SAID)) {
  if (english_.includes("{")) patterns.push({ matches: matcher(english_), german });
  else fixedSentences.set(english_, german);
}

function matcher(text: string): RegExp {
  const parts = text
    .split(/(\{\w+\})/)
    .map((part) =>
      part.startsWith("{")
        ? `(?<${part.slice(1, -1)}>.+?)`
        : part.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"),
    );
  return new RegExp(`^${parts.join("")}$`, "s");
}

/** Parts that people give names to: they stay as they are, also where one is "2.5". */
const GIVEN = new Set(["name", "place", "reason", "topic", "frame", "scene", "parts"]);
/** Parts that are said, too. */
const SAID_TOO = new Set(["what", "why", "where", "side", "because"]);
/** A figure, or a point on the floor. */
const FIGURES = /^\(?-?\d+(\.\d+)?(, -?\d+(\.\d+)?)?\)?$/;

/**
 * What somebody called something stays as it is called; what is said inside of it is said in German,
 * and figures are written as there.
 */
function filled(german: string, found: Record<string, string>): string {
  return german.replace(/\{(\w+)\}/g, (_, name) => {
    const part = found[name] ?? "";
    if (SAID_TOO.has(name)) return germanOf(part) ?? part;
    if (GIVEN.has(name) || !FIGURES.test(part)) return part;
    return part.replace(", ", " | ").replaceAll(".", ",").replaceAll("-", "−");
  });
}

/** The German of what the console or the robot said in English; null where the page has none. */
function germanOf(said: string): string | null {
  const known = fixedSentences.get(said);
  if (known !== undefined) return known;
  const whole = ofSentences(said);
  if (whole !== null) return whole;
  for (const { matches, german } of patterns) {
    const found = matches.exec(said)?.groups;
    if (found !== undefined) return filled(german, found);
  }
  return null;
}

/** What came first, and how it ended: sentences in a row, of which each is known. */
function ofSentences(said: string): string | null {
  const parts = said.split(/(?<=[.!?]) /);
  if (parts.length < 2) return null;
  const german = parts.map((part) => {
    // What is put before another sentence gets its point there.
    const bare = part.endsWith(".") ? germanOf(part.slice(0, -1)) : null;
    return bare === null ? germanOf(part) : `${bare}.`;
  });
  return german.includes(null) ? null : german.join(" ");
}

/**
 * What the console or the robot says in English, in the language of the page where that is known.
 *
 * They speak English to everybody who asks, and to their logs. Names of components, reasons of
 * refusals and the like are known here by their words (`german/said.ts`, held to the sources of
 * both by a test); what is not known stays as it was said.
 */
export const told = (said: string): string =>
  language.get() === "en" ? said : (germanOf(said) ?? said);

/** For `lang` of what was told: English where it is not known in the language of the page. */
export const langOf = (said: string): "en" | undefined =>
  said === "" || germanOf(said) !== null ? undefined : english();
