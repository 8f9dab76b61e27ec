import { Button, TextInput } from "@mantine/core";
import { useMutation } from "@tanstack/react-query";
import { type FormEvent, useState } from "react";
import { saveRecording } from "../../api/recordingsClient";
import { Choice } from "../../ui/controls/Choice";
import { Problem } from "../../ui/Problem";
import page from "../../ui/page.module.css";
import { STRETCHES } from "../model/words";
import classes from "./Recordings.module.css";

/** Keeps what the flight recorder would soon go over. */
export function KeepForm({ onKept }: { onKept: () => void }) {
  const [seconds, setSeconds] = useState("300");
  const [name, setName] = useState("");
  const keep = useMutation({
    mutationFn: () => saveRecording(Number(seconds), name.trim()),
    onSuccess: () => {
      setName("");
      onKept();
    },
  });
  const submit = (event: FormEvent) => {
    event.preventDefault();
    keep.mutate();
  };
  return (
    <form className={page.section} aria-label="Keep a recording" onSubmit={submit}>
      <div className={classes.keep}>
        <Choice
          aria-label="Which stretch to keep"
          data={STRETCHES}
          value={seconds}
          onChange={setSeconds}
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
        <Button
          type="submit"
          variant="default"
          loading={keep.isPending}
          data-testid="recording-keep"
        >
          Keep
        </Button>
      </div>
      {keep.isSuccess && (
        <p className={page.muted} role="status">
          Kept as {keep.data.name}.
        </p>
      )}
      <Problem error={keep.error} testId="recording-error" />
    </form>
  );
}
