import { Button } from "@mantine/core";
import { useState } from "react";
import { useRobot } from "../state/RobotContext";
import { t } from "../texts/text";
import { Band } from "../ui/Band";

/** A page that is open for weeks outlives the console that it came from. */
export function UpdateBand() {
  const { version } = useRobot();
  const [from, setFrom] = useState(version);
  if (from === null && version !== null) setFrom(version);
  if (from === null || version === null || version === from) return null;
  return (
    <Band
      tone="notice"
      title={t("The console is {version} now", { version })}
      testId="update-band"
      action={
        <Button variant="default" size="compact-md" onClick={() => location.reload()}>
          {t("Reload")}
        </Button>
      }
    >
      {t("This page is of {from}: reload it when you can look away for a moment.", { from })}
    </Band>
  );
}
