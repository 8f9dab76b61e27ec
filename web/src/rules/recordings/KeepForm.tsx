import { Button, Select, TextInput } from "@mantine/core";
import { type FormEvent, useState } from "react";
import { type ApiError, asApiError } from "../../api/errors";
import { saveRecording } from "../../api/recordingsClient";
import page from "../../ui/page.module.css";
import classes from "./Recordings.module.css";

const STRETCHES = [
  { value: "60", label: "the last minute" },
  { value: "300", label: "the last 5 minutes" },
  { value: "600", label: "the last 10 minutes" },
  { value: "0", label: "all that is recorded" },
];

/** Keeps what the flight recorder would soon go over. */
export function KeepForm({ onKept }: { onKept: () => void }) {
  const [seconds, setSeconds] = useState("300");
  const [name, setName] = useState("");
  const [busy, setBusy] = useState(false);
  const [done, setDone] = useState("");
  const [error, setError] = useState<ApiError | null>(null);
  const keep = (event: FormEvent) => {
    event.preventDefault();
    setBusy(true);
    setError(null);
    setDone("");
    saveRecording(Number(seconds), name.trim())
      .then(
        (saved) => {
          setDone(`Kept as ${saved.name}.`);
          setName("");
          onKept();
        },
        (failure: unknown) => setError(asApiError(failure)),
      )
      .finally(() => setBusy(false));
  };
  return (
    <form className={page.section} aria-label="Keep a recording" onSubmit={keep}>
      <div className={classes.keep}>
        <Select
          size="sm"
          aria-label="Which stretch to keep"
          allowDeselect={false}
          data={STRETCHES}
          value={seconds}
          onChange={(value) => value !== null && setSeconds(value)}
        />
        <TextInput
          size="sm"
          aria-label="Name of the recording"
          placeholder="name, else the time"
          maxLength={100}
          value={name}
          data-testid="recording-name"
          onChange={(event) => setName(event.currentTarget.value)}
        />
        <Button type="submit" variant="default" loading={busy} data-testid="recording-keep">
          Keep
        </Button>
      </div>
      {done !== "" && (
        <p className={page.muted} role="status">
          {done}
        </p>
      )}
      {error !== null && (
        <p className={page.problem} role="alert" data-testid="recording-error">
          {error.title} {error.remedy}
        </p>
      )}
    </form>
  );
}
