import type { CheckReport, Prospect } from "../../api/ruleTypes";
import page from "../../ui/page.module.css";
import { StatusMark } from "../../ui/StatusMark";
import { actsAtOnce, mayAct } from "../model/prospects";
import { sentence } from "../model/words";
import classes from "./TrueNow.module.css";

/** First of all: what is true at this moment, and will fire once it is applied. */
export function TrueNow({ report }: { report: CheckReport }) {
  if (report.now === "") return null;
  const warns = report.prospects.some(actsAtOnce);
  return (
    <p
      className={warns ? classes.warning : page.note}
      data-testid="true-now"
      data-warns={warns || undefined}
    >
      {warns && <StatusMark level="degraded" />}
      <span>{sentence(report.now)}</span>
    </p>
  );
}

interface Props {
  prospects: readonly Prospect[];
  /** Names of rules by id. */
  names: ReadonlyMap<string, string>;
}

/** Before the button: rules that may stop or move the robot as soon as they are applied. */
export function ActsAtOnce({ prospects, names }: Props) {
  const acting = prospects.filter(mayAct);
  if (acting.length === 0) return null;
  const warns = acting.some(actsAtOnce);
  return (
    <div
      className={warns ? classes.warning : page.note}
      role={warns ? "alert" : undefined}
      data-testid="acts-at-once"
    >
      {warns && <StatusMark level="degraded" />}
      <div>
        <strong>
          {warns
            ? "This may stop or move the robot as soon as it is applied."
            : "Whether this stops or moves the robot at once is not known yet."}
        </strong>
        <ul className={classes.list}>
          {acting.map((each) => (
            <li key={each.rule_id}>
              "{names.get(each.rule_id) ?? each.rule_id}": {each.text}.
            </li>
          ))}
        </ul>
        {warns && "Apply it in shadow first, or wait until its condition is false."}
      </div>
    </div>
  );
}
