import { Button, TextInput } from "@mantine/core";
import { useMutation } from "@tanstack/react-query";
import { useState } from "react";
import { addNote } from "../api/timelineClient";
import { t } from "../texts/text";
import { Problem } from "../ui/Problem";
import classes from "./Timeline.module.css";

/** A line of one's own: a wheel was changed, a door stood open. */
export function NoteForm() {
  const [title, setTitle] = useState("");
  const note = useMutation({
    mutationFn: () => addNote({ title: title.trim(), text: "" }),
    onSuccess: () => setTitle(""),
  });
  return (
    <form
      className={classes.note}
      onSubmit={(event) => {
        event.preventDefault();
        if (title.trim() !== "" && !note.isPending) note.mutate();
      }}
    >
      <TextInput
        size="sm"
        className={classes.grow}
        aria-label={t("A note for the timeline")}
        placeholder={t("Write a note: wheel changed, door stood open…")}
        maxLength={200}
        value={title}
        data-testid="timeline-note"
        onChange={(event) => {
          setTitle(event.currentTarget.value);
          note.reset();
        }}
      />
      <Button
        type="submit"
        size="sm"
        variant="default"
        disabled={title.trim() === ""}
        loading={note.isPending}
        data-testid="timeline-note-add"
      >
        {t("Add")}
      </Button>
      <Problem error={note.error} />
    </form>
  );
}
