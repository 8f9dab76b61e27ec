import { CloseButton, Kbd } from "@mantine/core";
import { type Phrase, t } from "../texts/text";
import classes from "./HelpPanel.module.css";

const KEYS: [string, Phrase][] = [
  ["Space", "Stop the robot, wherever you are not writing text"],
  ["Ctrl Space", "Stop the robot, in a text field, too, where Space is a blank"],
  ["G", "Goal tool on or off"],
  ["O", "Locate tool on or off: say where the robot is"],
  ["M", "Measure tool on or off: how far it is"],
  ["Enter", "Go or Set, when the card shows it"],
  ["Esc", "Drop the goal, place or points, then leave the tool"],
  ["D", "Drive by hand: the panel; with the wheel W A S D or the arrows, Esc gives it up"],
  ["F", "Follow the robot"],
  ["T", "Top view"],
  ["L", "Layers"],
  ["C", "Camera: what the robot sees"],
  ["P", "Places"],
  ["R", "Rules"],
  ["E", "Timeline: what has happened"],
  ["?", "This help"],
];

const GESTURES: [Phrase, Phrase][] = [
  ["Tap, goal tool on", "A point; the robot chooses its heading"],
  ["Press, drag, release", "A point with the heading of the drag"],
  ["The same, Locate tool on", "Where the robot is, and which way it looks"],
  ["Taps, Measure tool on", "How far it is from one to the next"],
  ["Drag the scene", "Turn; right button or two fingers move it"],
  ["Wheel or pinch", "Nearer and farther"],
  ["Hold the stick", "Drive; the robot stands when you let go"],
  ["Hold the release", "One second, or hold Enter on it"],
];

/** What stands on the key; those of a letter are the same everywhere. */
function keyText(key: string): string {
  if (key === "Space") return t("Space");
  return key === "Ctrl" ? t("Ctrl") : key;
}

/** The keys and gestures, beside the scene and not over it where there is room. */
export function HelpPanel({ onClose }: { onClose: () => void }) {
  return (
    <aside className={classes.panel} aria-label={t("Help")} data-testid="help-panel">
      <header className={classes.head}>
        <h2>{t("Keys and gestures")}</h2>
        <CloseButton size="lg" aria-label={t("Close help")} onClick={onClose} />
      </header>
      <dl className={classes.list}>
        {KEYS.map(([key, what]) => (
          <div key={key}>
            <dt>
              {key.split(" ").map((each) => (
                <Kbd key={each} mr={4}>
                  {keyText(each)}
                </Kbd>
              ))}
            </dt>
            <dd>{t(what)}</dd>
          </div>
        ))}
      </dl>
      <dl className={classes.gestures}>
        {GESTURES.map(([gesture, what]) => (
          <div key={gesture}>
            <dt>{t(gesture)}</dt>
            <dd>{t(what)}</dd>
          </div>
        ))}
      </dl>
    </aside>
  );
}
