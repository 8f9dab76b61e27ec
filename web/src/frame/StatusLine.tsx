import type { Localisation, Pose } from "../api/types";
import { ControlLine } from "../control/ControlLine";
import { ageText, degreesText, signed } from "../format";
import { DrivenBy } from "../hand/DrivenBy";
import { mapFit } from "../state/localisation";
import { POSE_DEADLINE_S } from "../state/overall";
import { useRobot } from "../state/RobotContext";
import { memoInLanguage } from "../texts/memoInLanguage";
import { t } from "../texts/text";
import { lengthUnit, shown, speedUnit } from "../texts/units";
import classes from "./StatusLine.module.css";

/** Where the robot is, how old that is, and who else looks. */
export const StatusLine = memoInLanguage(function StatusLine() {
  const { state, elapsed, frozen, connected } = useRobot();
  const scan = state?.streams.find((stream) => stream.key === "scan");
  return (
    <footer className={classes.line} data-testid="status-line">
      <span className={classes.link} data-frozen={frozen || undefined}>
        {frozen ? (connected ? t("No data") : t("Disconnected")) : t("Live")}
      </span>
      <ControlLine />
      <PoseText pose={state?.pose ?? null} elapsed={elapsed} />
      {state !== null && <FitText localisation={state.localisation} elapsed={elapsed} />}
      {scan?.age != null && (
        <span className={classes.extra}>
          {t("scan {age}", { age: ageText(scan.age + elapsed) })}
        </span>
      )}
      <span className={classes.gap} />
      <DrivenBy place="line" />
      {state !== null && (
        <span className={classes.extra}>
          {t("{viewers, plural, one {only you watch} other {# pages watch}}", {
            viewers: state.viewers,
          })}
        </span>
      )}
    </footer>
  );
});

function FitText({ localisation, elapsed }: { localisation: Localisation; elapsed: number }) {
  const { level, figure, sentence } = mapFit(localisation, elapsed);
  return (
    <span
      data-testid="map-fit"
      data-level={level}
      className={level === "unknown" ? classes.stale : classes.fit}
      title={sentence}
    >
      {level === "degraded" && "▲ "}
      {t("map fit {figure}", { figure })}
    </span>
  );
}

function PoseText({ pose, elapsed }: { pose: Pose | null; elapsed: number }) {
  if (pose === null) {
    return (
      <span data-testid="pose" className={classes.stale}>
        {t("position unknown")}
      </span>
    );
  }
  const age = pose.age + elapsed;
  const stale = age > POSE_DEADLINE_S;
  return (
    <span data-testid="pose" className={stale ? classes.stale : undefined}>
      x {signed(shown(pose.x), 2)} y {signed(shown(pose.y), 2)} {lengthUnit()} ·{" "}
      {degreesText(pose.yaw)} · {signed(shown(pose.v), 2)} {speedUnit()}
      {stale && ` · ${t("{age} old", { age: ageText(age) })}`}
    </span>
  );
}
