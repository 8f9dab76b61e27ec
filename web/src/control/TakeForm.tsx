import { Button, TextInput } from "@mantine/core";
import { useMutation } from "@tanstack/react-query";
import { useState } from "react";
import { takeControl } from "../api/controlClient";
import { t } from "../texts/text";
import { Problem } from "../ui/Problem";
import classes from "./Control.module.css";

/** Takes control from another person, and says why. */
export function TakeForm({ onDone }: { onDone?: () => void }) {
  const [reason, setReason] = useState("");
  const take = useMutation({ mutationFn: takeControl, onSuccess: () => onDone?.() });
  return (
    <form
      className={classes.take}
      onSubmit={(event) => {
        event.preventDefault();
        take.mutate(reason);
      }}
    >
      <TextInput
        label={t("Why you take it")}
        size="md"
        maxLength={200}
        value={reason}
        onChange={(event) => setReason(event.currentTarget.value)}
        data-testid="control-reason"
      />
      <Button
        type="submit"
        size="md"
        variant="default"
        loading={take.isPending}
        disabled={reason.trim() === ""}
        data-testid="control-take"
      >
        {t("Take control")}
      </Button>
      <Problem error={take.error} testId="control-take-problem" />
    </form>
  );
}
