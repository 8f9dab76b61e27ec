import { Button } from "@mantine/core";
import { IconArrowBackUp, IconX } from "@tabler/icons-react";
import { GestureBar } from "../goal/GestureBar";
import { t } from "../texts/text";
import { Problem } from "../ui/Problem";
import classes from "./Measure.module.css";
import { measuredText } from "./measureText";
import type { MeasureTool } from "./useMeasureTool";

/** How far it is along what was pressed. */
export function MeasureCard({ tool }: { tool: MeasureTool }) {
  const { points, problem, error, set, toggle } = tool;
  const first =
    points.length === 0 ? t("Press two points of the floor, or drag.") : t("One more point.");
  return (
    <GestureBar testId="measure-card">
      <span role="status" className={classes.told} data-testid="measured">
        {problem || (measuredText(points) ?? first)}
      </span>
      <Problem error={error} testId="measure-error" />
      {points.length > 0 && (
        <Button
          size="compact-md"
          variant="default"
          leftSection={<IconArrowBackUp size={18} aria-hidden />}
          onClick={() => set(points.slice(0, -1))}
          data-testid="measure-undo"
        >
          {t("Remove last point")}
        </Button>
      )}
      {points.length > 1 && (
        <Button
          size="compact-md"
          variant="default"
          onClick={() => set([])}
          data-testid="measure-clear"
        >
          {t("Clear points")}
        </Button>
      )}
      <Button
        size="compact-md"
        variant="default"
        leftSection={<IconX size={18} aria-hidden />}
        onClick={toggle}
        data-testid="measure-done"
      >
        {t("Done")}
      </Button>
    </GestureBar>
  );
}
