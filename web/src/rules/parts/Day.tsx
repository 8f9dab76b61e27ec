import { dayText } from "../model/words";
import classes from "./Day.module.css";

/** The line above an entry of the past with which another day begins. */
export function Day({ time, newer }: { time: number; newer: number }) {
  const text = dayText(time, newer);
  return text === null ? null : <div className={classes.day}>{text}</div>;
}
