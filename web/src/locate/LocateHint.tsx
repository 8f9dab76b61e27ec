import { GestureHint } from "../goal/GestureHint";
import { percentText } from "../state/localisation";
import { t } from "../texts/text";
import type { LocateTool } from "./useLocateTool";

/** What to do while the tool is on; while it drags, how well scan and map agree. */
export function LocateHint({ tool }: { tool: LocateTool }) {
  return (
    <GestureHint name="locate" tool={tool}>
      <span data-testid="locate-looked">
        {tool.looked !== null
          ? t("Scan and map agree {percent} here.", { percent: percentText(tool.looked) })
          : t("Press where the robot is, drag to where it looks and release.")}
      </span>
    </GestureHint>
  );
}
