import type { Stream } from "../api/types";
import { ageText, hertzText } from "../format";
import { streamWord } from "../state/causes";
import { streamLevel, streamStale } from "../state/overall";
import type { Level } from "../ui/StatusMark";
import classes from "./Health.module.css";
import { HealthRow } from "./HealthRow";

export function StreamRow({ stream, elapsed }: { stream: Stream; elapsed: number }) {
  const stale = streamStale(stream, elapsed);
  const level = streamLevel(stream, elapsed);
  return (
    <HealthRow
      level={level}
      label={stream.label}
      word={wordOf(stream, level, elapsed)}
      age={stream.age === null ? "–" : ageText(stream.age + elapsed)}
      stale={stale}
      testId={`stream-${stream.key}`}
    >
      <dl className={classes.facts}>
        <dt>Topic</dt>
        <dd>{stream.topic === null ? "none found" : <code>{stream.topic}</code>}</dd>
        {stream.rate !== null && (
          <>
            <dt>Rate</dt>
            <dd data-testid="stream-rate">{hertzText(stream.rate)}</dd>
          </>
        )}
        <dt>Deadline</dt>
        <dd>
          {stream.deadline === null
            ? "none: sent when it changes"
            : `${stream.deadline} s; older is late`}
        </dd>
      </dl>
    </HealthRow>
  );
}

function wordOf(stream: Stream, level: Level, elapsed: number): string {
  // No path is the normal state of a robot without a goal.
  if (stream.age === null) return stream.key === "path" ? "None yet" : "Not received";
  if (level === "healthy") return "";
  if (level === "unknown") return "Unknown";
  return streamWord(stream, elapsed) === "lost" ? "Lost" : "Late";
}
