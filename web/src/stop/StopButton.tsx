import { t } from "../texts/text";
import classes from "./Stop.module.css";
import { useStop } from "./StopContext";
import { StopFace } from "./StopFace";

/** Always on screen while somebody is logged in. */
export function StopButton() {
  const { stop, press } = useStop();
  return <StopFace stop={stop} press={press} hint={t("Space")} />;
}

/** What a panel leaves free in its lower right corner, where STOP is. */
export function StopPlace() {
  return <div className={classes.place} aria-hidden />;
}
