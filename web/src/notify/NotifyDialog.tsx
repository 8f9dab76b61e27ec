import { Modal, Switch, TextInput } from "@mantine/core";
import { useState } from "react";
import { t } from "../texts/text";
import { useNotify } from "./Notifier";
import classes from "./Notify.module.css";
import { play } from "./sound";

/** What browsers allow by https or on the machine itself only. */
/** Asks the browser, and shows a first message: some let only installed pages do so. */
async function mayMessage(): Promise<boolean> {
  if ((await Notification.requestPermission()) !== "granted") return false;
  try {
    new Notification("Kompass Console", { body: t("This is how you will be told."), tag: "first" });
    return true;
  } catch (error) {
    if (error instanceof TypeError) return false;
    throw error;
  }
}

const canMessage = () => window.isSecureContext && "Notification" in window;

/** How this browser tells of what happens to the robot. */
export function NotifyDialog({ opened, onClose }: { opened: boolean; onClose: () => void }) {
  return (
    <Modal
      opened={opened}
      onClose={onClose}
      title={t("Notifications")}
      closeButtonProps={{ "aria-label": t("Close notifications") }}
      data-testid="notify-dialog"
    >
      <Settings />
    </Modal>
  );
}

function Settings() {
  const { settings, change } = useNotify();
  const [refused, setRefused] = useState(false);
  const { quiet } = settings;

  const askForMessages = async (wanted: boolean) => {
    const allowed = wanted && (await mayMessage());
    setRefused(wanted && !allowed);
    change({ message: allowed });
  };
  return (
    <div className={classes.items}>
      <p className={classes.what}>
        {t(
          "This browser tells you when the robot stops, fails, gives a goal up, or waits for a person.",
        )}
      </p>
      <Switch
        label={t("With a sound")}
        checked={settings.sound}
        onChange={({ currentTarget: { checked } }) => {
          change({ sound: checked });
          if (checked) play(false); // heard once, and the browser lets it be heard from then on
        }}
        data-testid="notify-sound"
      />
      <Switch
        label={t("With a message, while I look elsewhere")}
        checked={settings.message}
        disabled={!canMessage()}
        description={
          !canMessage()
            ? t("Browsers allow it over https only, or on the robot itself.")
            : refused
              ? t(
                  "This browser refuses it. Allow notifications for this page in its settings, if it has them.",
                )
              : undefined
        }
        onChange={({ currentTarget: { checked } }) => void askForMessages(checked)}
        data-testid="notify-message"
      />
      <Switch
        label={t("Not during quiet hours")}
        checked={quiet !== null}
        onChange={({ currentTarget: { checked } }) =>
          change({ quiet: checked ? { from: "20:00", to: "06:00" } : null })
        }
        data-testid="notify-quiet"
      />
      {quiet !== null && (
        <div className={classes.hours}>
          <TextInput
            type="time"
            label={t("from")}
            value={quiet.from}
            onChange={({ currentTarget: { value } }) =>
              value !== "" && change({ quiet: { ...quiet, from: value } })
            }
          />
          <TextInput
            type="time"
            label={t("to")}
            value={quiet.to}
            onChange={({ currentTarget: { value } }) =>
              value !== "" && change({ quiet: { ...quiet, to: value } })
            }
          />
        </div>
      )}
    </div>
  );
}
