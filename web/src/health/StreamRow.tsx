import type { Stream } from "../api/types";
import { ageText } from "../format";
import { type Level, streamStale } from "../state/overall";
import classes from "./Health.module.css";
import { HealthRow } from "./HealthRow";

export function StreamRow({ stream, elapsed }: { stream: Stream; elapsed: number }) {
  const stale = streamStale(stream, elapsed);
  const level: Level = stream.age === null ? "unknown" : stale ? "degraded" : "healthy";
  return (
    <HealthRow
      level={level}
      label={stream.label}
      word={stream.age === null ? "Not received" : stale ? "Late" : ""}
      age={stream.age === null ? "–" : ageText(stream.age + elapsed)}
      stale={stale}
      testId={`stream-${stream.key}`}
    >
      <dl className={classes.facts}>
        <dt>Topic</dt>
        <dd>{stream.topic === null ? "none found" : <code>{stream.topic}</code>}</dd>
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
