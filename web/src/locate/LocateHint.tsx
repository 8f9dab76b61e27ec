import { Button } from "@mantine/core";
import { IconKeyboard, IconX } from "@tabler/icons-react";
import classes from "../goal/Goal.module.css";
import { percentText } from "../state/localisation";
import type { LocateTool } from "./useLocateTool";

/** What the hand can do while the tool is on; while it drags, how well scan and map agree. */
export function LocateHint({ tool }: { tool: LocateTool }) {
  return (
    <div className={classes.hint}>
      <span data-testid="locate-looked">
        {tool.looked !== null
          ? `Scan and map agree ${percentText(tool.looked)} here.`
          : "Press where the robot is, drag to where it looks and release."}
      </span>
      <span className={classes.hintActions}>
        <Button
          size="compact-md"
          variant="default"
          leftSection={<IconKeyboard size={18} aria-hidden />}
          onClick={() => tool.type(!tool.typing)}
          data-testid="locate-type"
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
