import { UnstyledButton } from "@mantine/core";
import { IconDatabase, IconHeartbeat } from "@tabler/icons-react";
import { useState } from "react";
import { GoalStatus } from "../goal/GoalStatus";
import { DataPanel } from "../health/DataPanel";
import { HealthPanel } from "../health/HealthPanel";
import { StopButton } from "../stop/StopButton";
import classes from "./BottomPanel.module.css";

type Tab = "health" | "data";

const TABS: { key: Tab; label: string; Icon: typeof IconHeartbeat }[] = [
  { key: "health", label: "Health", Icon: IconHeartbeat },
  { key: "data", label: "Data", Icon: IconDatabase },
];

/** What the right column is on a tablet or a phone: a sheet that opens from the bottom. */
export function BottomPanel({ startOpen }: { startOpen: boolean }) {
  const [open, setOpen] = useState<Tab | null>(startOpen ? "health" : null);
  return (
    <aside className={classes.bottom} aria-label="Robot">
      {open !== null && (
        <div className={classes.sheet} id="sheet">
          {open === "health" ? <HealthPanel /> : <DataPanel />}
        </div>
      )}
      <div className={classes.bar}>
        <div className={classes.left}>
          <GoalStatus />
          <div className={classes.tabs}>
            {TABS.map(({ key, label, Icon }) => (
              <UnstyledButton
                key={key}
                className={classes.tab}
                aria-expanded={open === key}
                aria-controls="sheet"
                data-testid={`tab-${key}`}
                onClick={() => setOpen(open === key ? null : key)}
              >
                <Icon size={20} aria-hidden />
                {label}
              </UnstyledButton>
            ))}
          </div>
        </div>
        <StopButton />
      </div>
    </aside>
  );
}
