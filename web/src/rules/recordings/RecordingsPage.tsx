import { bytesText } from "../../format";
import { useNow } from "../../state/RobotContext";
import { Problem } from "../../ui/Problem";
import page from "../../ui/page.module.css";
import { useRules } from "../context/RulesContext";
import { leftText } from "../model/words";
import { KeepForm } from "./KeepForm";
import { RecordingRow } from "./RecordingRow";
import classes from "./Recordings.module.css";
import { useRecordings } from "./useRecordings";

/** What was kept of the flight recorder: keep more, take one along, delete one. */
export function RecordingsPage({ name }: { name: string | null }) {
  const { mayEdit } = useRules();
  const { list, error, reload } = useRecordings();
  const now = useNow();
  const ring = list?.ring ?? null;
  const named = name === null || list?.recordings.some((each) => each.name === name);
  return (
    <div className={page.page} data-testid="recordings">
      <Problem error={error} />
      {list === null && error === null && <p className={page.muted}>Reading the recordings…</p>}
      {list?.here === true && (
        <p className={page.muted} data-testid="ring-state">
          {ring === null
            ? "The flight recorder has nothing: it is switched off, or has just begun."
            : `The flight recorder has the last ${leftText(now - ring.begin)} (${bytesText(ring.size)}).`}{" "}
          {bytesText(list.free)} free on the robot.
        </p>
      )}
      {mayEdit && list !== null && (list.ring !== null || !list.here) && (
        <KeepForm onKept={reload} />
      )}
      {list?.here === false && (
        <p className={page.note}>
          This console runs on another machine than the robot: recordings can be kept from here, and
          are looked at in the robot's own console.
        </p>
      )}
      {!named && list?.here === true && (
        <p className={page.note} role="status" data-testid="recording-gone">
          {name} is not here: it is written six seconds after its firing, and only the newest 20 of
          these stay.
        </p>
      )}
      {list?.here === true && list.recordings.length === 0 && (
        <p className={page.empty}>
          Nothing was kept yet. Severe firings are kept by themselves, with the half minute around
          them.
        </p>
      )}
      <ul className={classes.list} aria-label="Recordings">
        {list?.recordings.map((recording) => (
          <RecordingRow
            key={recording.name}
            recording={recording}
            wanted={recording.name === name}
            onDeleted={reload}
          />
        ))}
      </ul>
    </div>
  );
}
