import type { LogLine } from "../api/types";
import { countText } from "../format";
import { whenText } from "../texts/dates";
import { english } from "../texts/language";
import { t } from "../texts/text";
import { type Level, StatusMark } from "../ui/StatusMark";
import classes from "./Log.module.css";

const MARKS: Record<LogLine["level"], Level> = {
  debug: "healthy",
  info: "healthy",
  warning: "degraded",
  error: "failed",
  fatal: "failed",
};

/**
 * One line of the robot's log.
 *
 * @param label of the component that wrote it; empty where it is not one.
 */
export function LogRow({ line, label, now }: { line: LogLine; label: string; now: number }) {
  const lines = line.text.includes("\n");
  return (
    <>
      <div className={classes.row} data-testid="log-line" data-level={line.level}>
        <StatusMark level={MARKS[line.level]} />
        <span className={classes.when}>{whenText(line.time, now)}</span>
        <span className={classes.what}>
          <span className={classes.node}>
            {label === "" ? line.node : label}
            {line.level !== "info" && <b> · {t(line.level)}</b>}
          </span>
          {/* Its columns say something where it has lines: a traceback, a table. */}
          <span
            className={lines ? classes.lines : classes.text}
            title={line.where || undefined}
            lang={english()}
          >
            {line.text}
          </span>
        </span>
      </div>
      {line.left_out > 0 && (
        <p className={classes.gap} data-testid="log-gap">
          {leftOutText(line.left_out)}
        </p>
      )}
    </>
  );
}

export const leftOutText = (count: number): string =>
  count === 1
    ? t("Here one line was left out: they came too fast.")
    : t("Here at least {count} lines were left out: they came too fast.", {
        count: countText(count),
      });
