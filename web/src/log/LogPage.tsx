import { Button, TextInput } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { IconPlayerPause, IconPlayerPlay } from "@tabler/icons-react";
import { useState } from "react";
import type { LogLevel } from "../api/types";
import { useNow, useRobot } from "../state/RobotContext";
import { Choice } from "../ui/controls/Choice";
import { Problem } from "../ui/Problem";
import page from "../ui/page.module.css";
import classes from "./Log.module.css";
import { LogRow } from "./LogRow";
import { useLog } from "./useLog";

const LEVELS = [
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
  const labels = new Map(state?.components.map(({ name, label }) => [name, label]));
  const lines = log.lines ?? [];
  const nodes = [...new Set([...log.nodes, ...(node === ALL ? [] : [node])])].sort();
  const asked = level !== "debug" || node !== ALL || text !== "";
  return (
    <div className={page.page} data-testid="log">
      <div className={classes.tools}>
        <TextInput
          size="sm"
          className={classes.grow}
          aria-label="Only lines with these words"
          placeholder="only with …"
          maxLength={200}
          value={typed}
          data-testid="log-text"
          onChange={(event) => setTyped(event.currentTarget.value)}
        />
        <Choice
          aria-label="Only of this node"
          className={classes.choice}
          data={[
            { value: ALL, label: "all nodes" },
            ...nodes.map((name) => ({ value: name, label: labels.get(name) ?? name })),
          ]}
          value={node}
          data-testid="log-node"
          onChange={setNode}
        />
        <Choice
          aria-label="How bad at least"
          className={classes.choice}
          data={LEVELS}
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
          {paused ? "Go on" : "Pause"}
        </Button>
      </div>
      {paused && (
        <p className={page.muted} role="status" data-testid="log-paused">
          {log.waiting === 0
            ? "Paused. Nothing has come since."
            : `Paused. ${log.waiting.toLocaleString("en")} ${log.waiting === 1 ? "line has" : "lines have"} come since, of all kinds.`}
        </p>
      )}
      <Problem error={log.error} />
      {log.lines === null && log.error === null && <p className={page.muted}>Reading the log…</p>}
      {log.lines !== null && lines.length === 0 && (
        <p className={page.empty}>
          {state?.log.available === false
            ? "No node of the robot writes a log: nothing publishes on /rosout."
            : asked
              ? "No line like that."
              : "Nothing was logged since the console was started."}
        </p>
      )}
      <ul
        className={classes.list}
        aria-label="Log of the robot"
        data-stale={!log.fresh || undefined}
      >
        {lines.map((line) => (
          <li key={line.number}>
            <LogRow line={line} label={labels.get(line.node) ?? ""} now={now} />
          </li>
        ))}
      </ul>
      {log.more && (
        <p className={page.muted}>Older lines are not shown: ask for fewer kinds of them.</p>
      )}
    </div>
  );
}
