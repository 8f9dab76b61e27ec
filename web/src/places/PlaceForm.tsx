import { Button, TextInput } from "@mantine/core";
import { type FormEvent, useState } from "react";
import type { ApiError } from "../api/errors";
import { t } from "../texts/text";
import { broughtIntoView } from "../ui/broughtIntoView";
import { Problem } from "../ui/Problem";
import page from "../ui/page.module.css";
import classes from "./Places.module.css";
import { nameProblem, noteProblem } from "./placeText";

interface Props {
  /** What the form does, for who cannot see it. */
  title: string;
  name?: string;
  note?: string;
  /** What to know before it is saved; it can be saved all the same. */
  warning?: string;
  busy: boolean;
  error: ApiError | null;
  onSave: (name: string, note: string) => void;
  onCancel: () => void;
}

/** The name of a place, and what there is to say of it. */
export function PlaceForm(props: Props) {
  const { title, busy, error, onSave, onCancel } = props;
  const [name, setName] = useState(props.name ?? "");
  const [note, setNote] = useState(props.note ?? "");
  const [asked, setAsked] = useState(false);
  const wrong = { name: nameProblem(name), note: noteProblem(note) };

  const submit = (event: FormEvent) => {
    event.preventDefault();
    setAsked(true);
    if (wrong.name === null && wrong.note === null) onSave(name.trim(), note.trim());
  };
  const leave = (event: { key: string; stopPropagation: () => void }) => {
    if (event.key !== "Escape") return;
    event.stopPropagation();
    onCancel();
  };
  return (
    <form
      ref={broughtIntoView}
      className={classes.form}
      onSubmit={submit}
      aria-label={title}
      noValidate
    >
      <TextInput
        label={t("Name")}
        value={name}
        autoFocus
        autoComplete="off"
        error={asked ? wrong.name : null}
        onChange={(event) => setName(event.currentTarget.value)}
        onKeyDown={leave}
        data-testid="place-name"
      />
      <TextInput
        label={t("Note")}
        placeholder={t("May be empty")}
        value={note}
        autoComplete="off"
        error={asked ? wrong.note : null}
        onChange={(event) => setNote(event.currentTarget.value)}
        onKeyDown={leave}
        data-testid="place-note"
      />
      {props.warning !== undefined && props.warning !== "" && (
        <p className={page.note} role="status" data-testid="place-warning">
          {props.warning}
        </p>
      )}
      <Problem error={error} testId="place-problem" />
      <div className={classes.buttons}>
        <Button type="submit" size="compact-md" loading={busy} data-testid="place-save">
          {t("Save")}
        </Button>
        <Button variant="default" size="compact-md" onClick={onCancel}>
          {t("Leave it")}
        </Button>
      </div>
    </form>
  );
}
