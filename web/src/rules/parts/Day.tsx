import { dayText } from "../../texts/dates";
import { type Language, language } from "../../texts/language";
import classes from "./Day.module.css";

interface Props {
  time: number;
  newer: number;
  /** Of the list; where it is not told, that of the page. */
  of?: Language;
}

/** The line above an entry of the past with which another day begins. */
export function Day({ time, newer, of = language.get() }: Props) {
  const text = dayText(time, newer, of);
  return text === null ? null : <div className={classes.day}>{text}</div>;
}
