import { UnstyledButton } from "@mantine/core";
import { IconChevronRight } from "@tabler/icons-react";
import type { Firing } from "../../api/ruleTypes";
import { useNow } from "../../state/RobotContext";
import { whenText } from "../../texts/dates";
import { t } from "../../texts/text";
import { StatusMark } from "../../ui/StatusMark";
import { useNav } from "../context/RulesNav";
import { Day } from "../parts/Day";
import classes from "./Firings.module.css";
import { outcomeLevel, outcomeText } from "./outcome";

/** Entries of the journal; each opens to its explanation. */
export function FiringList({ firings }: { firings: readonly Firing[] }) {
  const nav = useNav();
  const now = useNow();
  return (
    <ul className={classes.list}>
      {firings.map((firing, index) => (
        <li key={firing.number} data-testid={`firing-${firing.rule_id}`} data-kind={firing.kind}>
          <Day time={firing.time} newer={firings[index - 1]?.time ?? now} />
          <UnstyledButton
            className={classes.row}
            onClick={() => nav.go({ at: "why", id: firing.rule_id, firing })}
          >
            <StatusMark level={outcomeLevel(firing)} />
            <span className={classes.when}>{whenText(firing.time, now)}</span>
            <span className={classes.name}>{firing.name || firing.rule_id}</span>
            <span className={classes.outcome}>{outcomeText(firing)}</span>
            <span className={classes.revision}>
              {t("rev {revision}", { revision: firing.revision })}
            </span>
            <IconChevronRight size={16} aria-hidden className={classes.chevron} />
          </UnstyledButton>
        </li>
      ))}
    </ul>
  );
}
