import { useStop } from "../stop/StopContext";
import classes from "./Control.module.css";
import { useControl } from "./useControl";

/** On a phone, below the scene: who else has control. Who drives by hand is told of there already. */
export function ControlLine() {
  const control = useControl();
  const { drive } = useStop();
  if (control?.whose !== "other" || (drive?.driven_by ?? "") !== "") return null;
  return (
    <span className={classes.line} data-testid="control-line">
      {control.text}
    </span>
  );
}
