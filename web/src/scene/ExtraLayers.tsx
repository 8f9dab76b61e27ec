import { Menu } from "@mantine/core";
import { IconCheck } from "@tabler/icons-react";
import type { Extra, View } from "../api/types";
import { useRobot } from "../state/RobotContext";
import { t } from "../texts/text";
import { extraNote, kindText, MOST_EXTRAS } from "./extraText";
import { coloursOf, extraColour } from "./flat/colours";
import classes from "./Layers.module.css";

interface Props {
  view: View;
  onToggle: (topic: string) => void;
}

/** Topics of the robot that can be drawn besides what the page draws anyway; each off at first. */
export function ExtraLayers({ view, onToggle }: Props) {
  const { state } = useRobot();
  const there = state?.extras ?? [];
  const gone = view.extras.filter((topic) => !there.some((each) => each.topic === topic));
  if (there.length + gone.length === 0) return null;
  const item = (topic: string, words: string, note: string | null) => {
    const on = view.extras.includes(topic);
    const full = !on && view.extras.length >= MOST_EXTRAS;
    return (
      <Menu.CheckboxItem
        key={topic}
        checked={on}
        checkIcon={<IconCheck size={18} aria-hidden />}
        disabled={full}
        data-testid={`extra-${topic}`}
        onChange={() => onToggle(topic)}
        mih={44}
      >
        <span className={classes.topic}>
          {on && (
            <i
              className={classes.swatch}
              style={{ background: extraColour(topic, coloursOf(view.theme)) }}
            />
          )}
          {topic}
        </span>
        <span className={classes.words}>{words}</span>
        {on && note !== null && <span className={classes.note}>▲ {note}</span>}
        {full && (
          <span className={classes.words}>
            {t("{most} of these at most: switch one off first.", { most: MOST_EXTRAS })}
          </span>
        )}
      </Menu.CheckboxItem>
    );
  };
  return (
    <>
      <Menu.Divider />
      <Menu.Label>{t("More on this robot")}</Menu.Label>
      {there.map((extra: Extra) => item(extra.topic, kindText(extra), extraNote(extra)))}
      {gone.map((topic) => item(topic, t("Nobody publishes it now."), null))}
    </>
  );
}
