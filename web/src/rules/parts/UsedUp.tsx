import { Button } from "@mantine/core";
import { IconRotate } from "@tabler/icons-react";
import { useMutation } from "@tanstack/react-query";
import { resetRule } from "../../api/rulesClient";
import type { Rule, RuleStatus } from "../../api/ruleTypes";
import { useNow } from "../../state/RobotContext";
import { Problem } from "../../ui/Problem";
import { useRules } from "../context/RulesContext";
import { ruleName, usedUpText } from "../model/words";
import classes from "./UsedUp.module.css";

interface Props {
  rule: Rule;
  status: RuleStatus | null;
}

/** A rule that fires once, and has: it guards nothing any more, until somebody resets it. */
export function UsedUp({ rule, status }: Props) {
  const { mayEdit } = useRules();
  const now = useNow();
  const startAfresh = useMutation({ mutationFn: () => resetRule(rule.id) });
  if (status === null || status.state !== "used up") return null;
  return (
    <div className={classes.band} role="status" data-testid="used-up">
      <span>{usedUpText(status, now)}</span>
      {mayEdit && (
        <Button
          variant="default"
          size="compact-md"
          leftSection={<IconRotate size={16} aria-hidden />}
          aria-label={`Reset ${ruleName(rule)}: let it fire again`}
          loading={startAfresh.isPending}
          data-testid="used-up-reset"
          onClick={() => startAfresh.mutate()}
        >
          Reset
        </Button>
      )}
      <Problem error={startAfresh.error} />
    </div>
  );
}
