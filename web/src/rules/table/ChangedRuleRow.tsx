import { Button } from "@mantine/core";
import type { Rule } from "../../api/ruleTypes";
import { ruleName } from "../model/words";
import classes from "./Table.module.css";

/** A rule that will be gone once the changes are applied. */
export function ChangedRuleRow({ rule, onUndo }: { rule: Rule; onUndo: () => void }) {
  return (
    <li className={classes.rule} data-removed data-testid={`rule-${rule.id}`}>
      <div className={classes.first}>
        <s className={classes.name}>{ruleName(rule)}</s>
        <span className={classes.change}>will be deleted</span>
        <Button variant="default" size="compact-md" onClick={onUndo}>
          Keep it
        </Button>
      </div>
    </li>
  );
}
