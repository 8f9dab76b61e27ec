import { Button } from "@mantine/core";
import { IconKeyboard, IconX } from "@tabler/icons-react";
import classes from "./Goal.module.css";
import type { GoalTool } from "./useGoalTool";

/** What the hand can do while the goal tool is on. */
export function GoalHint({ tool }: { tool: GoalTool }) {
  return (
    <div className={classes.hint}>
      <span>Tap the floor, or press, drag to the heading and release.</span>
      <span className={classes.hintActions}>
        <Button
          size="compact-md"
          variant="default"
          leftSection={<IconKeyboard size={18} aria-hidden />}
          onClick={() => tool.type(!tool.typing)}
          data-testid="goal-type"
        >
          Type coordinates
        </Button>
        <Button
          size="compact-md"
          variant="default"
          leftSection={<IconX size={18} aria-hidden />}
          onClick={tool.toggle}
        >
          Done
        </Button>
      </span>
    </div>
  );
}
