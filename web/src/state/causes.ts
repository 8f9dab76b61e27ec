import type { Component, State, Stream } from "../api/types";
import { listText, wholeAgeText } from "../format";
import { language } from "../texts/language";
import { type Phrase, type Text, t } from "../texts/text";
import { told } from "../texts/told";
import type { Level } from "../ui/StatusMark";
import { mapFit, SET_ITS_PLACE } from "./localisation";
import { componentLevel, FROZEN_S, streamStale } from "./overall";

/** Why the robot is not well: the one thing that the others wait for. */
export interface Cause {
  level: Level;
  /** What it is, without its time: for the top bar. */
  name: string;
  /** The same with its time. */
  text: string;
  /** What follows from it, each a part of a sentence. */
  effects: string[];
  /** What a person can do about it. */
  advice: string;
  /** Further things that are wrong and do not come from it. */
  others: number;
  /** It is over in a moment, or is told at the goal: nothing for a band across the scene. */
  minor: boolean;
}

/** A stream that is this much over its deadline (s) is lost, and not late any more. */
const LOST_AFTER_S = 2;
/** For so long (s) the top bar tells of a restart; the component's row does for longer. */
export const RESTART_TOLD_S = 60;

/** What is wrong, with the topics that nothing comes from and who is at fault. */
interface Root extends Omit<Cause, "effects" | "others"> {
  /** The lower, the nearer to the source. */
  rank: number;
  /** Within a rank the one that has lasted longest, s. */
  lasted: number;
  topics: string[];
  components: string[];
}

/**
 * The cause of what is wrong, or null while nothing is.
 *
 * Components say which topics they wait for, and the console knows who publishes them: so blame is
 * followed to where it ends. A topic that does come is no cause, whoever waits for it: after a
 * restart a planner has no map for a moment, and the map is as it was.
 */
export function rootCause(state: State | null, elapsed: number): Cause | null {
  if (state === null || elapsed > FROZEN_S) return null;
  const ill = state.components.filter((c) => componentLevel(c, elapsed) !== "healthy");
  // Of another stack the console knows its topics, and not what they mean to it.
  const ours = state.components.length > 0;
  const roots = [
    ...(ours ? processRoots(state, elapsed) : []),
    ...(ours ? streamRoots(state, ill, elapsed) : []),
    ...(ours ? componentRoots(state, ill, elapsed) : []),
    ...placeRoots(state, ill, elapsed),
  ].sort((a, b) => a.rank - b.rank || b.lasted - a.lasted);
  const root = roots[0];
  if (root === undefined) return null;
  const waiting = whoWaits(root, ill);
  const covered = (other: Root) =>
    other === root ||
    isOfSameTopics(other, root) ||
    other.components.some((name) => root.components.includes(name)) ||
    (other.components.length > 0 && other.components.every((name) => waiting.has(name)));
  const labels = ill.filter((c) => waiting.has(c.name)).map((c) => told(c.label));
  const { level, name, text, advice, minor } = root;
  return {
    level,
    name,
    text,
    advice,
    minor,
    effects: [...held(state), ...waitingText(labels)],
    others: roots.filter((other) => !covered(other)).length,
  };
}

/** What nobody of ours is to blame for is one thing, however many tell of it. */
const isOfSameTopics = (one: Root, other: Root): boolean =>
  one.components.length === 0 &&
  one.topics.length > 0 &&
  one.topics.every((topic) => other.topics.some(same(topic)));

/** Who has just been started again and is well: what is left of a fault that healed by itself. */
export function lastRestart(state: State | null): string | null {
  let newest: { label: string; ago: number } | null = null;
  for (const { label, process } of state?.components ?? []) {
    const ago = process?.restarted ?? null;
    if (ago === null || ago > RESTART_TOLD_S) continue;
    if (newest === null || ago < newest.ago) newest = { label, ago };
  }
  return newest === null
    ? null
    : t("{label} restarted {age} ago", {
        label: told(newest.label),
        age: wholeAgeText(newest.ago),
      });
}

/** `late` while it may still come, `lost` when it is. */
export function streamWord(stream: Stream, elapsed: number): "" | "late" | "lost" | "missing" {
  if (stream.age === null) return stream.key === "path" ? "" : "missing";
  if (!streamStale(stream, elapsed)) return "";
  const over = stream.age + elapsed - (stream.deadline ?? 0);
  return stream.deadline !== null && over > LOST_AFTER_S ? "lost" : "late";
}

/** A process that died, hangs or was given up explains all that its components do not do. */
function processRoots(state: State, elapsed: number): Root[] {
  const labels = new Map(state.components.map((c) => [c.name, told(c.label)]));
  const found = new Map<string, NonNullable<Component["process"]>>();
  for (const each of state.processes) found.set(each.name, each);
  const owned = new Map<string, string[]>();
  for (const { name, process } of state.components) {
    if (process === null || process === undefined) continue;
    found.set(process.name, process);
    owned.set(process.name, [...(owned.get(process.name) ?? []), name]);
  }
  return [...found.values()].flatMap((process): Root[] => {
    const words = LOST[process.state];
    if (words === undefined) return [];
    const components = owned.get(process.name) ?? [];
    const label = listText(
      components.length > 0
        ? components.map((name) => labels.get(name) ?? name)
        : [told(sentenceCase(process.name))],
    );
    const why = process.reason === "" ? "" : ` (${process.reason})`;
    const outputs = state.components
      .filter((c) => components.includes(c.name))
      .flatMap((c) => c.outputs);
    return [
      {
        rank: 0,
        lasted: elapsed,
        level: "failed",
        name: t(words.is, { label }),
        text: `${t(words.is, { label })}${why}`,
        advice: t(words.advice),
        minor: false,
        topics: outputs,
        components,
      },
    ];
  });
}

type Died = Extract<Text, `{label} ${"died" | "hangs"}${string}`>;

const LOST: Partial<Record<string, { is: Died; advice: Phrase }>> = {
  dead: {
    is: "{label} died",
    advice: "It is being started again by itself. If it dies again, look at its log.",
  },
  stuck: {
    is: "{label} hangs",
    advice: "If it does not come back, it is ended and started again by itself.",
  },
  "given up": {
    is: "{label} died too often and is not started again",
    advice: "Look at its log for the reason, then start the robot's program anew.",
  },
};

/** A topic from which nothing comes though whoever publishes it is well, or is not of the stack. */
function streamRoots(state: State, ill: Component[], elapsed: number): Root[] {
  return state.streams.flatMap((stream): Root[] => {
    const word = streamWord(stream, elapsed);
    if (word === "" || (stream.topic !== null && publishedBy(stream.topic, ill))) return [];
    const { topic } = stream;
    const wanted = topic !== null && ill.some((c) => c.src_topics.some(same(topic)));
    // What nobody has ever sent is nothing that went wrong, unless somebody needs it.
    if (word === "missing" && !wanted && stream.key !== "odometry") return [];
    const age = (stream.age ?? 0) + elapsed;
    const lost = word === "lost";
    const label = told(stream.label);
    const { name, text } = {
      missing: {
        name: t("{label} missing", { label }),
        text: t("{label}: nothing received yet", { label }),
      },
      late: { name: t("{label} is late", { label }), text: t("{label} is late", { label }) },
      lost: {
        name: t("{label} lost", { label }),
        text: t("{label} lost {age} ago", { label, age: wholeAgeText(age) }),
      },
    }[word];
    return [
      {
        rank: word === "late" ? 2 : 1,
        lasted: age,
        level: lost || wanted ? "failed" : "degraded",
        name,
        text,
        advice: adviceFor(stream, word),
        minor: word === "late",
        topics: stream.topic === null ? [] : [stream.topic],
        components: [],
      },
    ];
  });
}

function adviceFor(stream: Stream, word: "late" | "lost" | "missing"): string {
  const topic = stream.topic ?? t("its topic");
  switch (stream.key) {
    case "scan":
      return t("Check the scanner's power and cable, and the driver that publishes {topic}.", {
        topic,
      });
    case "odometry":
      return t("Check the base and the localization, which publish {topic}.", { topic });
    case "map":
      return word === "missing"
        ? t("Load a map, or start the map server.")
        : t("Check the map server.");
    case "local_map":
      return t("Check who publishes {topic}.", { topic });
    case "path":
      return "";
  }
}

/** What a component says of itself, where neither its process nor a topic explains it. */
function componentRoots(state: State, ill: Component[], elapsed: number): Root[] {
  const silent = ill.filter((c) => c.age + elapsed > FROZEN_S);
  if (silent.length === state.components.length && silent.length > 1) {
    const age = Math.min(...silent.map((c) => c.age)) + elapsed;
    return [
      {
        rank: 0,
        lasted: age,
        level: "unknown",
        name: t("Robot's program silent"),
        text: t("Nothing heard of the robot's program for {age}", { age: wholeAgeText(age) }),
        advice: t("Check that it runs, and the network between it and this console."),
        minor: false,
        topics: [],
        components: silent.map((c) => c.name),
      },
    ];
  }
  return ill.flatMap((component): Root[] => {
    const label = told(component.label);
    const state_ = component.process?.state ?? "unknown";
    if (LOST[state_] !== undefined) return []; // its process is the cause
    const age = component.age + elapsed;
    const base = {
      lasted: age,
      level: componentLevel(component, elapsed),
      topics: component.outputs,
      components: [component.name],
      minor: false,
    };
    if (age > FROZEN_S) {
      const text = t("{label} silent for {age}", { label, age: wholeAgeText(age) });
      const advice = t("Check that it runs, and the network between it and this console.");
      return [{ ...base, rank: 0, name: t("{label} silent", { label }), text, advice }];
    }
    const said = plainMessage(component.message);
    const why = said === "" ? "" : `: ${told(said)}`;
    const failed = {
      name: t("{label} failed", { label }),
      text: `${t("{label} failed", { label })}${why}`,
    };
    switch (component.status) {
      case "algorithm_failure":
        return [
          {
            ...base,
            rank: 5,
            name: t("{label} finds no solution", { label }),
            text: `${t("{label} finds no solution", { label })}${why}`,
            advice: t("Move what is in the way, or pick another goal."),
            minor: true,
          },
        ];
      case "system_failure": {
        const others = component.src_components.filter((name) => name !== component.name);
        if (others.some((name) => ill.some((c) => c.name === name))) return [];
        const topics = component.src_topics;
        if (topics.some((topic) => isExplained(topic, state, ill, component.name, elapsed)))
          return [];
        const missing = topics.filter((topic) => !arrives(topic, state, elapsed));
        const late = /too old: (it comes [^;]*)/.exec(said)?.[1];
        if (late !== undefined && topics[0] !== undefined) {
          // It does come, long after it was measured.
          const what = topicLabel(topics[0], state);
          const name = t("{what} comes too late", { what });
          return [
            {
              ...base,
              rank: 2,
              name,
              text: `${name}: ${told(late)}`,
              advice: t(
                "Check the network to the machine that sends it, and that machine's clock.",
              ),
              topics,
              components: [],
            },
          ];
        }
        if (topics.length > 0 && missing.length === 0) {
          // It does come: this one has not heard it yet.
          const restarted = component.process?.restarted ?? null;
          const what = listText(topics.map((topic) => topicText(topic, state)));
          return [
            {
              ...base,
              rank: 4,
              name: t("{label} is not ready", { label }),
              text:
                restarted === null || restarted > RESTART_TOLD_S
                  ? t("{label} has not heard {what} yet", { label, what })
                  : t("{label}, restarted {age} ago, has not heard {what} yet", {
                      label,
                      age: wholeAgeText(restarted),
                      what,
                    }),
              advice: t(
                "It is sent, so this should pass by itself; if not, restart this component.",
              ),
              minor: restarted !== null && restarted <= RESTART_TOLD_S,
            },
          ];
        }
        if (topics.length === 0) return [{ ...base, rank: 3, ...failed, advice: t(DETAILS) }];
        const what = listText(missing.map((topic) => topicText(topic, state)));
        return [
          {
            ...base,
            rank: 2,
            name: t("{label} gets nothing", { label }),
            text: t("{label} gets nothing on {what}", { label, what }),
            advice: t("Check who publishes {topic}.", { topic: listText(missing) }),
          },
        ];
      }
      default:
        return [{ ...base, rank: 3, ...failed, advice: t(DETAILS) }];
    }
  });
}

/** A robot that is not where it thinks plans from there: so it explains who finds no solution. */
function placeRoots({ localisation }: State, ill: Component[], elapsed: number): Root[] {
  const { level, figure } = mapFit(localisation, elapsed);
  if (level !== "degraded") return [];
  return [
    {
      rank: 1.5,
      lasted: elapsed,
      level,
      name: t("Place doubtful"),
      text: t("Scan and map agree {figure}", { figure }),
      advice: t(SET_ITS_PLACE),
      minor: false,
      topics: [],
      components: ill.filter((c) => c.status === "algorithm_failure").map((c) => c.name),
    },
  ];
}

const DETAILS: Phrase = "Health has the details; if it does not pass, restart this component.";

/** Whether what a component waits for is missing for a reason that is told of elsewhere. */
function isExplained(
  topic: string,
  state: State,
  ill: Component[],
  waits: string,
  elapsed: number,
): boolean {
  const others = ill.filter((c) => c.name !== waits);
  if (publishedBy(topic, others)) return true;
  const stream = streamOf(topic, state);
  return stream !== undefined && streamWord(stream, elapsed) !== "";
}

/** Whether the console hears this topic itself. */
function arrives(topic: string, state: State, elapsed: number): boolean {
  const stream = streamOf(topic, state);
  return stream !== undefined && streamWord(stream, elapsed) === "";
}

const publishedBy = (topic: string, components: Component[]): boolean =>
  components.some((c) => c.outputs.some(same(topic)));

/** Who waits for the root, or for somebody who waits for it. */
function whoWaits(root: Root, ill: Component[]): Set<string> {
  const waiting = new Set<string>();
  const topics = [...root.topics];
  const blamed = new Set(root.components);
  for (let grew = true; grew; ) {
    grew = false;
    for (const each of ill) {
      if (waiting.has(each.name) || root.components.includes(each.name)) continue;
      const waits =
        each.src_topics.some((topic) => topics.some(same(topic))) ||
        each.src_components.some((name) => name !== each.name && blamed.has(name));
      if (!waits) continue;
      waiting.add(each.name);
      blamed.add(each.name);
      topics.push(...each.outputs);
      grew = true;
    }
  }
  return waiting;
}

function held({ drive }: State): string[] {
  if (drive === null || !drive.available) return [];
  if (drive.stopped) return [t("robot stopped")];
  if (drive.limited_by === "") return [];
  const percent = Math.round(drive.speed_factor * 100);
  if (percent <= 0) return [t("robot held")];
  return percent < 100 ? [t("robot slowed to {percent} %", { percent })] : [];
}

function waitingText(labels: string[]): string[] {
  if (labels.length === 0) return [];
  const [first, ...rest] = labels;
  const list = listText([first ?? "", ...rest.map(inSentence)]);
  return [
    t("{n, plural, one {{list} waits for it} other {{list} wait for it}}", {
      n: labels.length,
      list,
    }),
  ];
}

/** A label that does not begin a sentence; German nouns keep their capital. */
const inSentence = (label: string): string =>
  language.get() === "en" ? label.toLowerCase() : label;

/** What the page calls a topic in a sentence, where it has a word for it. */
function topicText(topic: string, state: State): string {
  const stream = streamOf(topic, state);
  return stream === undefined ? topic : t("the {label}", { label: inSentence(told(stream.label)) });
}

/** The same at the beginning of one. */
function topicLabel(topic: string, state: State): string {
  const stream = streamOf(topic, state);
  return stream === undefined ? topic : told(stream.label);
}

const streamOf = (topic: string, state: State): Stream | undefined =>
  state.streams.find((each) => each.topic !== null && same(each.topic)(topic));

/** A component's message without the level that it begins with: the page has words of its own. */
function plainMessage(message: string): string {
  const said = message.replace(/^Failure: [A-Za-z]+(?: Level)?(?: - )?/, "");
  return said.charAt(0).toLowerCase() + said.slice(1);
}

const sentenceCase = (name: string): string => {
  const words = name.replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
};

/** Both spellings of a topic's name are one topic. */
const same =
  (one: string) =>
  (other: string): boolean =>
    one.replace(/^\/+/, "") === other.replace(/^\/+/, "");
