import { UnstyledButton } from "@mantine/core";
import { t } from "../texts/text";
import classes from "./Stop.module.css";
import { type StopState, stopLabel } from "./stopMachine";

interface Props {
  stop: StopState;
  press: () => void;
  /** The key that stops, as it stands on the button. */
  hint: string;
}

/**
 * Above everything, and pressable in every state. It stands beside the page and not in it: lists and
 * menus are laid over the whole page, and would lie over it, too.
 */
export function StopFace({ stop, press, hint }: Props) {
  const { word, spoken } = stopLabel(stop.phase);
  return (
    <UnstyledButton
      className={classes.button}
      data-phase={stop.phase}
      data-testid="stop-button"
      // On press, not on release: a finger that slips off has still stopped the robot.
      onPointerDown={(event) => {
        if (event.button === 0) press();
      }}
      onClick={(event) => {
        // Enter and assistive technology click without a pointer.
        if (event.detail === 0) press();
      }}
    >
      <span className={classes.word}>{word}</span>{" "}
      {stop.phase === "idle" && <span className={classes.hint}>{hint}</span>}
      {stop.phase === "stopped" && <span className={classes.hint}>{t("standstill ✓")}</span>}
      {stop.phase === "silent" && <span className={classes.hint}>{t("was stopped")}</span>}
      {stop.phase === "unconfirmed" && <span className={classes.hint}>{t("press again")}</span>}
      {/* Whoever speaks to the page says what stands on the button: its name begins with that. */}
      <span className="visually-hidden">. {spoken}</span>
    </UnstyledButton>
  );
}
