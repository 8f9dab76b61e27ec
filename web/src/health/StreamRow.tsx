import type { Stream } from "../api/types";
import { ageText, hertzText } from "../format";
import { streamWord } from "../state/causes";
import { streamLevel, streamStale } from "../state/overall";
import { t } from "../texts/text";
import { told } from "../texts/told";
import type { Level } from "../ui/StatusMark";
import classes from "./Health.module.css";
import { HealthRow } from "./HealthRow";

export function StreamRow({ stream, elapsed }: { stream: Stream; elapsed: number }) {
  const stale = streamStale(stream, elapsed);
  const level = streamLevel(stream, elapsed);
  return (
    <HealthRow
      level={level}
      label={told(stream.label)}
      word={wordOf(stream, level, elapsed)}
      age={stream.age === null ? "–" : ageText(stream.age + elapsed)}
      stale={stale}
      testId={`stream-${stream.key}`}
    >
      <dl className={classes.facts}>
        <dt>{t("Topic")}</dt>
        <dd>{stream.topic === null ? t("none found") : <code>{stream.topic}</code>}</dd>
        {stream.rate !== null && (
          <>
            <dt>{t("Rate")}</dt>
            <dd data-testid="stream-rate">{hertzText(stream.rate)}</dd>
          </>
        )}
        <dt>{t("Deadline")}</dt>
        <dd>
          {stream.deadline === null
            ? t("none: sent when it changes")
            : t("{deadline} s; older is late", { deadline: stream.deadline })}
        </dd>
      </dl>
    </HealthRow>
  );
}

function wordOf(stream: Stream, level: Level, elapsed: number): string {
  // No path is the normal state of a robot without a goal.
  if (stream.age === null) return stream.key === "path" ? t("None yet") : t("Not received");
  if (level === "healthy") return "";
  if (level === "unknown") return t("Unknown");
  return streamWord(stream, elapsed) === "lost" ? t("Lost") : t("Late");
}
