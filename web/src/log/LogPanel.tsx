import { UnstyledButton } from "@mantine/core";
import { useNav } from "../rules/context/RulesNav";
import { useNow, useRobot } from "../state/RobotContext";
import { Panel } from "../ui/Panel";
import classes from "./Log.module.css";
import { LogRow } from "./LogRow";
import { useLog } from "./useLog";

const SHOWN = 4;

/** What nodes complain of, beside their health: the newest warnings and errors. */
export function LogPanel() {
  const nav = useNav();
  const now = useNow();
  const { state } = useRobot();
  const { lines, error } = useLog({ level: "warning", node: "", text: "" }, SHOWN);
  const labels = new Map(state?.components.map(({ name, label }) => [name, label]));
  const none =
    lines === null
      ? "Nothing heard yet."
      : state?.log.available === false
        ? "No node of the robot writes a log."
        : "No warnings, and no errors.";
  return (
    <Panel title="Log" testId="log-panel" empty={null}>
      <div className={classes.compact}>
        {lines === null || lines.length === 0 ? (
          <p className={classes.none}>{error?.title ?? none}</p>
        ) : (
          lines.map((line) => (
            <LogRow key={line.number} line={line} label={labels.get(line.node) ?? ""} now={now} />
          ))
        )}
        <UnstyledButton
          className={classes.all}
          data-testid="log-all"
          onClick={() => nav.go({ at: "log" })}
        >
          The whole log
        </UnstyledButton>
      </div>
    </Panel>
  );
}
