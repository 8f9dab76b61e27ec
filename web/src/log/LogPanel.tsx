import { UnstyledButton } from "@mantine/core";
import { useNav } from "../rules/context/RulesNav";
import { useNow, useRobot } from "../state/RobotContext";
import { t } from "../texts/text";
import { told } from "../texts/told";
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
  const labels = new Map(state?.components.map(({ name, label }) => [name, told(label)]));
  const none =
    lines === null
      ? t("Nothing heard yet.")
      : state?.log.available === false
        ? t("No node of the robot writes a log.")
        : t("No warnings, and no errors.");
  return (
    <Panel title={t("Log")} testId="log-panel" empty={null}>
      <div className={classes.compact}>
        {lines === null || lines.length === 0 ? (
          <p className={classes.none}>{error === null ? none : told(error.title)}</p>
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
          {t("The whole log")}
        </UnstyledButton>
      </div>
    </Panel>
  );
}
