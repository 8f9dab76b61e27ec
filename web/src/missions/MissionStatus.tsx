import { Button, CloseButton } from "@mantine/core";
import { useMutation } from "@tanstack/react-query";
import { useEffect, useRef, useState } from "react";
import { steerMission } from "../api/missionsClient";
import type { MissionRun, RunVerb } from "../api/types";
import goal from "../goal/Goal.module.css";
import { isUnderWay, limitText, remaining } from "../goal/goalText";
import { useSession } from "../session/SessionContext";
import { useRobot } from "../state/RobotContext";
import { useStop } from "../stop/StopContext";
import { t } from "../texts/text";
import { langOf } from "../texts/told";
import { Problem } from "../ui/Problem";
import classes from "./Missions.module.css";
import { isOver, progressText, runLine } from "./missionText";

/** What ended so long (s) ago is no news. */
const OLD_NEWS_S = 600;

/** The mission that runs, for everybody; who may, steers it. `brief` beside what needs the room. */
export function MissionStatus({ brief = false }: { brief?: boolean }) {
  const { state, elapsed, frozen } = useRobot();
  const { session } = useSession();
  const { drive } = useStop();
  const [dismissed, setDismissed] = useState(0);
  const run = state?.missions.run ?? null;
  if (run === null) return null;
  const over = isOver(run);
  if (over && (run.number === dismissed || run.elapsed + elapsed > OLD_NEWS_S)) return null;
  const line = runLine(run, elapsed);
  // Its goal is told of here, and by nobody else.
  const its = run.phase === "driving" ? (state?.goal ?? null) : null;
  const limit = its !== null && isUnderWay(its) ? limitText(drive) : null;
  return (
    <section
      className={goal.status}
      data-testid="mission-status"
      data-phase={run.phase}
      data-tone={line.tone}
      data-under-way={!over || undefined}
      data-stale={frozen || undefined}
      data-brief={brief || undefined}
      aria-label={t("Mission")}
    >
      <div className={goal.statusText} role="status">
        <strong>{line.text}</strong>
        {its?.phase === "driving" && <span>{remaining(its)}</span>}
        {limit !== null && <span className={goal.limit}>▲ {limit}</span>}
        {brief && <span className={goal.detail}>{run.name}</span>}
        {(!brief || run.phase === "paused") && line.more !== "" && (
          <span className={goal.detail} lang={run.ask === "" ? langOf(run.reason) : undefined}>
            {line.more}
          </span>
        )}
        {!brief && (
          <>
            <span className={goal.detail}>
              {run.name} · {progressText(run)}
            </span>
            <span className={goal.place}>{t("begun by {by}", { by: run.by })}</span>
          </>
        )}
      </div>
      {over ? (
        <CloseButton
          size="lg"
          aria-label={t("Hide this mission")}
          onClick={() => setDismissed(run.number)}
        />
      ) : (
        session.role !== "viewer" && <Controls run={run} />
      )}
    </section>
  );
}

function Controls({ run }: { run: MissionRun }) {
  const steer = useMutation({
    mutationFn: (verb: RunVerb) => steerMission(run, verb),
  });
  // What kept it from going on is over, or another: what was said of it is true no more.
  const { drive } = useStop();
  const now = `${run.phase} ${drive?.stopped} ${drive?.driven_by}`;
  const before = useRef(now);
  const { isError, reset } = steer;
  useEffect(() => {
    if (before.current === now) return;
    before.current = now;
    if (isError) reset();
  }, [now, isError, reset]);
  const button = (verb: RunVerb, label: string, primary = false) => (
    <Button
      size="md"
      variant={primary ? "filled" : "default"}
      loading={steer.isPending && steer.variables === verb}
      disabled={steer.isPending}
      onClick={() => steer.mutate(verb)}
      data-testid={`mission-${verb}`}
    >
      {label}
    </Button>
  );
  return (
    <>
      <div className={classes.controls}>
        {run.phase === "paused" && button("resume", t("Resume"), true)}
        {run.phase === "asking" && button("confirm", t("Go on"), true)}
        {run.phase !== "paused" && button("pause", t("Pause"))}
        {button("skip", t("Skip"))}
        {button("cancel", t("Cancel"))}
      </div>
      <Problem error={steer.error} testId="mission-problem" />
    </>
  );
}
