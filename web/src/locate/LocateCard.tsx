import { Button, Loader } from "@mantine/core";
import { useLayoutEffect, useRef } from "react";
import classes from "../goal/Goal.module.css";
import { placeText } from "../goal/goalText";
import { useCardPlace } from "../goal/useCardPlace";
import { mapFit } from "../state/localisation";
import { useRobot } from "../state/RobotContext";
import { t } from "../texts/text";
import { langOf, told } from "../texts/told";
import { agreementText, movedText } from "./locateText";
import type { LocateDraft, LocateTool } from "./useLocateTool";

/** The answer to a pick, where the hand is: how well scan and map agree there, and Set; or why not. */
export function LocateCard({ tool, draft }: { tool: LocateTool; draft: LocateDraft }) {
  const first = useRef<HTMLButtonElement>(null);
  const { anchor, check, error, phase } = draft;
  // Nothing that was compared is known of a robot that is not heard.
  const { frozen } = useRobot();
  const { card, place, style } = useCardPlace(anchor, [phase, check, error]);
  const set = phase === "told";
  // What is doubted takes a press: Enter alone does not set it.
  const sure = check?.ok === true && check.note === "";
  const ready = set || (phase === "checked" && sure && error === null);

  useLayoutEffect(() => {
    if (ready && place !== null) first.current?.focus({ preventScroll: true });
  }, [ready, place]);

  return (
    <div
      ref={card}
      className={classes.card}
      data-testid="locate-card"
      data-phase={phase}
      role="dialog"
      aria-label={t("Place of the robot")}
      style={style}
    >
      <div aria-live="polite">
        {phase === "checking" ? (
          <p className={classes.lead}>
            <Loader size="xs" /> {t("Comparing…")}
          </p>
        ) : set ? (
          <Told />
        ) : (
          <Answer draft={draft} />
        )}
      </div>
      <div className={classes.actions}>
        {set ? (
          <Button ref={first} size="md" onClick={tool.toggle} data-testid="locate-done">
            {t("Done")}
          </Button>
        ) : (
          <>
            {check?.ok && (
              <Button
                ref={first}
                size="md"
                variant={sure ? "filled" : "default"}
                className={check.best ? classes.wide : undefined}
                onClick={() => tool.set()}
                loading={phase === "sending" && error === null}
                disabled={frozen}
                data-testid="locate-set"
              >
                {check.best ? t("Set the best place") : sure ? t("Set") : t("Set all the same")}
              </Button>
            )}
            {check?.ok && check.best && (
              <Button
                size="md"
                variant="default"
                disabled={frozen}
                onClick={() => tool.set(true)}
                data-testid="locate-exactly"
              >
                {t("As pressed")}
              </Button>
            )}
            <Button size="md" variant="default" onClick={tool.drop} data-testid="locate-cancel">
              {t("Cancel")}
            </Button>
          </>
        )}
      </div>
    </div>
  );
}

function Answer({ draft }: { draft: LocateDraft }) {
  const { check, error } = draft;
  const chosen = check?.best ?? check?.here;
  return (
    <>
      {error !== null && (
        <p className={classes.problem} lang={langOf(error.title)}>
          {told(error.title)} {told(error.remedy)}
        </p>
      )}
      {check !== null && !check.ok && (
        <p className={classes.problem} lang={langOf(check.message)}>
          {told(check.message)}
        </p>
      )}
      {check?.ok && chosen && (
        <>
          <p className={classes.lead}>{agreementText(chosen)}</p>
          {check.best && <p className={classes.detail}>{movedText(check)}</p>}
          <p className={classes.detail}>{placeText(chosen.x, chosen.y, chosen.yaw)}</p>
        </>
      )}
      {check?.ok && check.note && (
        <p className={classes.note} lang={langOf(check.note)}>
          {told(check.note)}
        </p>
      )}
    </>
  );
}

/** What came of it, as it is now. */
function Told() {
  const { state, elapsed } = useRobot();
  const { sentence } = state === null ? { sentence: "" } : mapFit(state.localisation, elapsed);
  return (
    <>
      <p className={classes.lead}>{t("The robot was told")}</p>
      <p className={classes.detail} data-testid="locate-now">
        {sentence}
      </p>
    </>
  );
}
