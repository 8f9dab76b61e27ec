import { Button, Popover, UnstyledButton } from "@mantine/core";
import { IconUserCheck } from "@tabler/icons-react";
import { useMutation } from "@tanstack/react-query";
import { useState } from "react";
import { askForControl, giveControl, takeControl } from "../api/controlClient";
import { useSession } from "../session/SessionContext";
import { useRobot } from "../state/RobotContext";
import { t } from "../texts/text";
import { Problem } from "../ui/Problem";
import classes from "./Control.module.css";
import type { ControlView } from "./controlText";
import { TakeForm } from "./TakeForm";
import { useControl } from "./useControl";

/** In the top bar, as soon as more than one looks: who has control of the robot. */
export function ControlBadge() {
  const control = useControl();
  const { state } = useRobot();
  const [open, setOpen] = useState(false);
  if (control === null || control.whose === "nobody") return null;
  const mine = control.whose === "mine";
  if (mine && (state?.viewers ?? 0) < 2) return null;
  return (
    <Popover opened={open} onChange={setOpen} position="bottom-end" width={300} trapFocus>
      <Popover.Target>
        <UnstyledButton
          className={classes.badge}
          data-mine={mine || undefined}
          data-testid="control-badge"
          aria-label={control.text}
          aria-expanded={open}
          onClick={() => setOpen(!open)}
        >
          <IconUserCheck size={18} aria-hidden />
          <span className={classes.badgeText}>{control.text}</span>
        </UnstyledButton>
      </Popover.Target>
      <Popover.Dropdown data-testid="control-panel">
        {mine ? (
          <Mine onDone={() => setOpen(false)} />
        ) : (
          <Others control={control} onDone={() => setOpen(false)} />
        )}
      </Popover.Dropdown>
    </Popover>
  );
}

function Mine({ onDone }: { onDone: () => void }) {
  const give = useMutation({ mutationFn: giveControl, onSuccess: onDone });
  return (
    <div className={classes.panel}>
      <p>
        {t("You drive this robot. Others look on, may ask you for it, and can always press STOP.")}
      </p>
      <Button
        variant="default"
        size="md"
        loading={give.isPending}
        onClick={() => give.mutate()}
        data-testid="control-give-up"
      >
        {t("Give control up")}
      </Button>
      <Problem error={give.error} testId="control-problem" />
    </div>
  );
}

function Others({ control, onDone }: { control: ControlView; onDone: () => void }) {
  const { session } = useSession();
  const ask = useMutation({ mutationFn: askForControl, onSuccess: onDone });
  const take = useMutation({ mutationFn: takeControl, onSuccess: onDone });
  if (session.role === "viewer") {
    return (
      <p className={classes.only}>
        {t("{text}. STOP works for everybody.", { text: control.text })}
      </p>
    );
  }
  if (control.own) {
    return (
      <div className={classes.panel}>
        <p>{t("You have control on another device.")}</p>
        <Button
          size="md"
          loading={take.isPending}
          onClick={() => take.mutate("")}
          data-testid="control-take"
        >
          {t("Take it here")}
        </Button>
        <Problem error={take.error} testId="control-problem" />
      </div>
    );
  }
  return (
    <div className={classes.panel}>
      <p>{t("{text}. You can look on, and press STOP.", { text: control.text })}</p>
      {control.waits === null && (
        <Button
          size="md"
          loading={ask.isPending}
          onClick={() => ask.mutate()}
          data-testid="control-ask"
        >
          {t("Ask for control")}
        </Button>
      )}
      <Problem error={ask.error} testId="control-problem" />
      {session.role === "engineer" && <TakeForm onDone={onDone} />}
    </div>
  );
}
