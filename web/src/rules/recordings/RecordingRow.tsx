import { Button } from "@mantine/core";
import { IconDownload, IconTrash } from "@tabler/icons-react";
import { useMutation } from "@tanstack/react-query";
import { useEffect, useRef, useState } from "react";
import { deleteRecording, recordingAddress } from "../../api/recordingsClient";
import type { Recording } from "../../api/ruleTypes";
import { bytesText, durationText } from "../../format";
import { useSession } from "../../session/SessionContext";
import { useNow } from "../../state/RobotContext";
import { broughtIntoView } from "../../ui/broughtIntoView";
import { Problem } from "../../ui/Problem";
import page from "../../ui/page.module.css";
import { whenText } from "../model/words";
import classes from "./Recordings.module.css";

interface Props {
  recording: Recording;
  /** Whether one came here to see this one. */
  wanted: boolean;
  onDeleted: () => void;
}

/** One recording: what, when, how long, how large. */
export function RecordingRow({ recording, wanted, onDeleted }: Props) {
  const { session } = useSession();
  const now = useNow();
  const row = useRef<HTMLLIElement>(null);
  useEffect(() => {
    if (wanted) broughtIntoView(row.current);
  }, [wanted]);
  const { name, saved, begin, end, size, messages, of_firing, problem } = recording;
  return (
    <li
      ref={row}
      className={classes.row}
      data-testid={`recording-${name}`}
      data-wanted={wanted || undefined}
    >
      <strong className={classes.name}>{name}</strong>
      <p className={page.muted}>
        {whenText(begin ?? saved, now)}
        {begin !== null && end !== null && ` · ${durationText(end - begin)}`} · {bytesText(size)}
        {messages > 0 && ` · ${messages.toLocaleString()} messages`}
        {of_firing && " · kept by a firing"}
      </p>
      {problem !== "" && <p className={page.problem}>{problem}</p>}
      <div className={classes.buttons}>
        {session.role !== "viewer" && (
          <Button
            component="a"
            variant="default"
            size="compact-md"
            leftSection={<IconDownload size={16} aria-hidden />}
            href={recordingAddress(name)}
            download={`${name}.mcap`}
            aria-label={`Download ${name}`}
            data-testid="recording-download"
          >
            Download
          </Button>
        )}
        {session.role === "engineer" && <DeleteButton name={name} onDeleted={onDeleted} />}
      </div>
    </li>
  );
}

/** A file that is gone cannot be had back: the button asks once. */
function DeleteButton({ name, onDeleted }: { name: string; onDeleted: () => void }) {
  const [asking, setAsking] = useState(false);
  const remove = useMutation({
    mutationFn: () => deleteRecording(name),
    onSuccess: onDeleted,
    onError: () => setAsking(false),
  });
  return (
    <>
      {asking ? (
        <>
          <Button
            variant="default"
            className={classes.sure}
            size="compact-md"
            loading={remove.isPending}
            autoFocus
            onClick={() => remove.mutate()}
            data-testid="recording-delete-sure"
          >
            Delete for good
          </Button>
          <Button variant="default" size="compact-md" onClick={() => setAsking(false)}>
            Leave it
          </Button>
        </>
      ) : (
        <Button
          variant="default"
          size="compact-md"
          leftSection={<IconTrash size={16} aria-hidden />}
          aria-label={`Delete ${name}`}
          onClick={() => setAsking(true)}
          data-testid="recording-delete"
        >
          Delete
        </Button>
      )}
      <Problem error={remove.error} />
    </>
  );
}
