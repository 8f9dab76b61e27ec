// @vitest-environment jsdom
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import ts from "typescript";
import { afterEach, describe, expect, test } from "vitest";
import { GERMAN } from "./german";
import { SAID } from "./german/said";
import { language, languageOf } from "./language";
import { formatOf, type Text, t } from "./text";
import { langOf, told } from "./told";

const TEXTS = Object.entries(GERMAN) as [Text, string][];

afterEach(() => language.choose("en"));

function filesUnder(folder: string, ending: RegExp): string[] {
  return readdirSync(folder, { withFileTypes: true }).flatMap((entry) => {
    const path = join(folder, entry.name);
    if (entry.isDirectory())
      return /node_modules|static/.test(path) ? [] : filesUnder(path, ending);
    return ending.test(path) ? [path] : [];
  });
}

/** All string literals of the page but those of the catalogues. */
function literalsOfPage(): Set<string> {
  const found = new Set<string>();
  for (const path of filesUnder("src", /(?<!\.test)\.tsx?$/)) {
    if (path.includes("german")) continue;
    const file = ts.createSourceFile(path, readFileSync(path, "utf8"), ts.ScriptTarget.Latest);
    const visit = (node: ts.Node) => {
      if (ts.isStringLiteral(node) || ts.isNoSubstitutionTemplateLiteral(node))
        found.add(node.text);
      if (ts.isPropertyAssignment(node) && ts.isIdentifier(node.name)) found.add(node.name.text);
      ts.forEachChild(node, visit);
    };
    visit(file);
  }
  return found;
}

/** What stands in braces of a message, and nothing of what is said of one or many. */
const namesIn = (message: string): string[] =>
  [
    ...new Set([...message.matchAll(/\{(\w+)(?=\}|, plural)/g)].map(([, name]) => name ?? "")),
  ].sort();
const tagsIn = (message: string): string[] =>
  [...message.matchAll(/<(\w+)>/g)].map(([, name]) => name ?? "").sort();

describe("the catalogue", () => {
  test("has no text that the page does not say any more", () => {
    const said = literalsOfPage();
    // Roles and phases of a process come from the console's schema.
    const schema = readFileSync("openapi.json", "utf8");
    const surplus = TEXTS.map(([text]) => text).filter(
      (text) => !said.has(text) && !schema.includes(`"${text}"`),
    );
    expect(surplus).toEqual([]);
  });

  test("has each text once", () => {
    const seen = new Map<string, string>();
    for (const path of filesUnder("src/texts/german", /\.ts$/)) {
      if (/said|index/.test(path)) continue;
      const file = ts.createSourceFile(path, readFileSync(path, "utf8"), ts.ScriptTarget.Latest);
      const visit = (node: ts.Node) => {
        if (ts.isPropertyAssignment(node) && !ts.isComputedPropertyName(node.name)) {
          const key = ts.isIdentifier(node.name)
            ? node.name.text
            : (node.name as ts.StringLiteral).text;
          expect(seen.get(key), key).toBeUndefined();
          seen.set(key, path);
        }
        ts.forEachChild(node, visit);
      };
      visit(file);
    }
  });

  test.each(TEXTS)("fills in the same in both languages: %s", (english, german) => {
    expect(namesIn(german)).toEqual(namesIn(english));
    expect(tagsIn(german)).toEqual(tagsIn(english));
    for (const of of ["en", "de"] as const) expect(() => formatOf(english, of)).not.toThrow();
  });

  test("keeps what the console and the robot say only as long as they say it", () => {
    const page = ["src/api/errors.ts", "src/stop/stopMachine.ts", "src/rules/changes/findings.ts"];
    const sources = [
      ...filesUnder("../kompass", /\.py$/),
      ...filesUnder("../kompass_console", /\.py$/),
      ...page,
    ]
      .map((path) => readFileSync(path, "utf8"))
      .join("\n")
      // A sentence that is too long for a line goes on in the next.
      .replace(/"\s*\n\s*f?"/g, "");
    for (const said of Object.keys(SAID))
      for (const part of said.split(/\{\w+\}/)) expect(sources).toContain(part);
  });
});

test("the language is the first of the browser's that the page has, else English", () => {
  expect(languageOf(["de-AT", "en"])).toBe("de");
  expect(languageOf(["fr-FR", "de"])).toBe("de");
  expect(languageOf(["fr-FR"])).toBe("en");
  expect(languageOf([])).toBe("en");
});

test("one and many are told apart in both languages", () => {
  const zones = (n: number) =>
    t("{n, plural, one {# zone} other {# zones}} of other maps, not in force", { n });
  expect(zones(1)).toBe("1 zone of other maps, not in force");
  language.choose("de");
  expect(zones(1)).toBe("1 Zone anderer Karten, nicht in Kraft");
  expect(zones(3)).toBe("3 Zonen anderer Karten, nicht in Kraft");
});

test("what the robot says is put into words where the page knows them, and else marked as English", () => {
  const known = "The goal (1.20, -0.50) is inside an obstacle.";
  expect([told(known), langOf(known)]).toEqual([known, undefined]);
  language.choose("de");
  expect(told(known)).toBe("Das Ziel (1,20 | −0,50) liegt in einem Hindernis.");
  expect(told("No path from (1.20, -0.50) to (3.00, 4.00) was found.")).toBe(
    "Kein Weg von (1,20 | −0,50) nach (3,00 | 4,00) gefunden.",
  );
  expect(told("Place saved: 2.5")).toBe("Ort gespeichert: 2.5");
  expect(langOf(known)).toBeUndefined();
  expect(told("Place saved: Mission")).toBe("Ort gespeichert: Mission");
  expect(told("Mission saved: Round")).toBe("Auftrag gespeichert: Round");
  expect(told("the process was killed by SIGKILL. Started again.")).toBe(
    "der Prozess wurde durch SIGKILL beendet. Neu gestartet.",
  );
  expect(langOf("A cat. Started again.")).toBe("en");
  expect(told("Sent the robot to (1.70, -0.50)")).toBe("Roboter geschickt nach 1,70 | −0,50");
  expect(told("Sent the robot to 2.5")).toBe("Roboter geschickt nach 2.5");
  expect(told("Revision 3 in force, the rules of revision 1")).toBe(
    "Revision 3 in Kraft, die Regeln von Revision 1",
  );
  expect(
    told("In the way: an obstacle of the map at (2.41, -0.50), 0.14 m ahead to the left."),
  ).toBe("Im Weg: ein Hindernis der Karte bei 2,41 | −0,50, 0,14 m voraus links.");
  expect(
    told("In the way: the keep-out zone 'Dock 2' at (2.41, 2.86), 0.14 m behind, for 23 s."),
  ).toBe("Im Weg: die Sperrzone 'Dock 2' bei 2,41 | 2,86, 0,14 m hinten, seit 23 s.");
  expect(
    told(
      "The drive manager holds the robot back: scan stale. Nothing is known to be in the way at (0.00, 1.50).",
    ),
  ).toBe(
    "Die Fahrsteuerung hält den Roboter zurück: ein Scanner oder eine Kamera schweigt. Im Weg ist bei 0,00 | 1,50 nichts bekannt.",
  );
  expect(told("No progress for 15 s; the drive manager holds the robot back: scan stale.")).toBe(
    "Seit 15 s kein Fortschritt; die Fahrsteuerung hält den Roboter zurück: ein Scanner oder eine Kamera schweigt.",
  );
  expect([told("A cat."), langOf("A cat.")]).toEqual(["A cat.", "en"]);
});
