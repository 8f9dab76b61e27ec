import { Button, TextInput } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { IconPlayerPause, IconPlayerPlay } from "@tabler/icons-react";
import { useState } from "react";
import type { LogLevel } from "../api/types";
import { countText } from "../format";
import { useNow, useRobot } from "../state/RobotContext";
import { type Phrase, t } from "../texts/text";
import { told } from "../texts/told";
import { Choice } from "../ui/controls/Choice";
import { Problem } from "../ui/Problem";
import page from "../ui/page.module.css";
import classes from "./Log.module.css";
import { LogRow } from "./LogRow";
import { useLog } from "./useLog";

const LEVELS: { value: string; label: Phrase }[] = [
  { value: "debug", label: "everything" },
  { value: "info", label: "without debug" },
  { value: "warning", label: "warnings and worse" },
  { value: "error", label: "errors only" },
];
const ALL = "";
const SHOWN = 500;

/** What the robot's nodes log, newest first. */
export function LogPage() {
  const { state } = useRobot();
  const now = useNow();
  const [level, setLevel] = useState<LogLevel>("info");
  const [node, setNode] = useState(ALL);
  const [typed, setTyped] = useState("");
  const [text] = useDebouncedValue(typed.trim(), 300);
  const [paused, setPaused] = useState(false);
  const log = useLog({ level, node, text }, SHOWN, paused);
  const labels = new Map(state?.components.map(({ name, label }) => [name, told(label)]));
  const lines = log.lines ?? [];
  const nodes = [...new Set([...log.nodes, ...(node === ALL ? [] : [node])])].sort();
  const asked = level !== "debug" || node !== ALL || text !== "";
  return (
    <div className={page.page} data-testid="log">
      <div className={classes.tools}>
        <TextInput
          size="sm"
          className={classes.grow}
          aria-label={t("Only lines with these words")}
          placeholder={t("only with …")}
          maxLength={200}
          value={typed}
          data-testid="log-text"
          onChange={(event) => setTyped(event.currentTarget.value)}
        />
        <Choice
          aria-label={t("Only of this node")}
          className={classes.choice}
          data={[
            { value: ALL, label: t("all nodes") },
            ...nodes.map((name) => ({ value: name, label: labels.get(name) ?? name })),
          ]}
          value={node}
          data-testid="log-node"
          onChange={setNode}
        />
        <Choice
          aria-label={t("How bad at least")}
          className={classes.choice}
          data={LEVELS.map(({ value, label }) => ({ value, label: t(label) }))}
          value={level}
          data-testid="log-level"
          onChange={(value) => setLevel(value as LogLevel)}
        />
        <Button
          variant="default"
          size="sm"
          aria-pressed={paused}
          leftSection={
            paused ? (
              <IconPlayerPlay size={16} aria-hidden />
            ) : (
              <IconPlayerPause size={16} aria-hidden />
            )
          }
          data-testid="log-pause"
          onClick={() => setPaused(!paused)}
        >
          {paused ? t("Go on") : t("Pause")}
        </Button>
      </div>
      {paused && (
        <p className={page.muted} role="status" data-testid="log-paused">
          {log.waiting === 0
            ? t("Paused. Nothing has come since.")
            : t(
                "Paused. {n, plural, one {One line has} other {{count} lines have}} come since, of all kinds.",
                { n: log.waiting, count: countText(log.waiting) },
              )}
        </p>
      )}
      <Problem error={log.error} />
      {log.lines === null && log.error === null && (
        <p className={page.muted}>{t("Reading the log…")}</p>
      )}
      {log.lines !== null && lines.length === 0 && (
        <p className={page.empty}>
          {state?.log.available === false
            ? t("No node of the robot writes a log: nothing publishes on /rosout.")
            : asked
              ? t("No line like that.")
              : t("Nothing was logged since the console was started.")}
        </p>
      )}
      <ul
        className={classes.list}
        aria-label={t("Log of the robot")}
        data-stale={!log.fresh || undefined}
      >
        {lines.map((line) => (
          <li key={line.number}>
            <LogRow line={line} label={labels.get(line.node) ?? ""} now={now} />
          </li>
        ))}
      </ul>
      {log.more && (
        <p className={page.muted}>{t("Older lines are not shown: ask for fewer kinds of them.")}</p>
      )}
    </div>
  );
}
