import { UnstyledButton } from "@mantine/core";
import { IconChevronRight } from "@tabler/icons-react";
import type { TimelineEntry } from "../api/types";
import { whenText } from "../texts/dates";
import { langOf, told } from "../texts/told";
import { StatusMark } from "../ui/StatusMark";
import classes from "./Timeline.module.css";
import { kindLabel, lengthText, markOf, sourceText } from "./timelineText";

interface Props {
  entry: TimelineEntry;
  labels: ReadonlyMap<string, string>;
  now: number;
  /** Where more is told of it; null where nothing is. */
  onOpen: (() => void) | null;
}

/** One line of what happened. */
export function TimelineRow({ entry, labels, now, onOpen }: Props) {
  const about = sourceText(entry, labels);
  const length = lengthText(entry, now);
  const said = (
    <>
      <StatusMark level={markOf(entry.level)} />
      <span className={classes.when}>{whenText(entry.time, now)}</span>
      <span className={classes.what}>
        <span className={classes.title}>
          {about !== "" && <b>{about}: </b>}
          <span lang={langOf(entry.title)}>{told(entry.title)}</span>
          {entry.who !== "" && <span className={classes.who}> · {entry.who}</span>}
        </span>
        {entry.text !== "" && (
          <span className={classes.text} lang={langOf(entry.text)}>
            {told(entry.text)}
          </span>
        )}
      </span>
      <span className={classes.length}>
        {length !== "" && <span data-lasts={entry.lasts || undefined}>{length}</span>}
        <span className={classes.kind}>{kindLabel(entry.kind)}</span>
      </span>
    </>
  );
  const test = `timeline-${entry.kind}`;
  return onOpen === null ? (
    <div className={classes.row} data-testid={test} data-level={entry.level}>
      {said}
      <span className={classes.chevron} />
    </div>
  ) : (
    <UnstyledButton
      className={classes.row}
      data-testid={test}
      data-level={entry.level}
      onClick={onOpen}
    >
      {said}
      <IconChevronRight size={16} aria-hidden className={classes.chevron} />
    </UnstyledButton>
  );
}
