import { Button } from "@mantine/core";
import { useEffect, useReducer } from "react";
import { openStop, stopWithoutLogin } from "../api/client";
import { useAsked } from "../api/queries";
import { useStopKey } from "../keys";
import { t } from "../texts/text";
import { told } from "../texts/told";
import { Band } from "../ui/Band";
import classes from "./Stop.module.css";
import { StopFace } from "./StopFace";
import { IDLE, type StopState, stopReducer } from "./stopMachine";
import { useStopPress } from "./useStopPress";

const PRESSED_MS = 250;
const WAITING_MS = 1000;

interface Props {
  send?: typeof stopWithoutLogin;
  /** Whether it is there where the console has none for who is not logged in. */
  always?: boolean;
}

/**
 * STOP for who is not logged in, where the console has one: the same button and the same key. It
 * only stops; what became of it is asked for, and a console that does not answer is told as that.
 */
export function OpenStop({ send = stopWithoutLogin, always = false }: Props) {
  const [stop, dispatch] = useReducer(stopReducer, IDLE);
  const { data, error } = useAsked({
    key: ["open stop"],
    ask: openStop,
    again: stop.phase === "stopping" ? PRESSED_MS : WAITING_MS,
  });
  const seen = error === null ? (data?.seen ?? null) : null;
  useEffect(() => {
    const look = () => dispatch({ type: "observed", drive: seen, now: performance.now() });
    look();
    const timer = window.setInterval(look, PRESSED_MS);
    return () => window.clearInterval(timer);
  }, [seen]);

  const { press, giveUp } = useStopPress(send, dispatch, stop.latched);

  // A console that does not answer may have one all the same: whoever presses it learns that.
  const offered = data === null ? error !== null : data.offered;
  return offered || always ? <Offered stop={stop} press={press} onLooked={giveUp} /> : null;
}

function Offered({
  stop,
  press,
  onLooked,
}: {
  stop: StopState;
  press: () => void;
  onLooked: () => void;
}) {
  useStopKey(press);
  return (
    <>
      <section className={classes.said} aria-label={t("Stop")}>
        {stop.phase === "unconfirmed" && (
          <Band tone="alarm" title={t("Stop is not confirmed")} testId="stop-unconfirmed">
            {told(stop.problem)} {told(stop.remedy)}
            {!stop.latched && (
              <Button variant="default" size="compact-md" onClick={onLooked} ml="sm">
                {t("I have looked")}
              </Button>
            )}
          </Band>
        )}
        {stop.phase === "stopped" && (
          <Band tone="stopped" title={t("Stopped")} testId="stop-band">
            {t("The robot stands, until an operator has logged in and releases it.")}
          </Band>
        )}
        {stop.phase === "silent" && (
          <Band tone="stale" title={t("Was stopped")} testId="stop-band-stale">
            {t("Nothing is heard of the robot now; it stays so until somebody releases it.")}
          </Band>
        )}
      </section>
      {/* The page begins in a text field, where the space bar alone is a blank. */}
      <StopFace stop={stop} press={press} hint={t("Ctrl Space")} />
    </>
  );
}
