import { useStop } from "../stop/StopContext";
import classes from "./Hand.module.css";
import { useHand } from "./HandContext";
import { drivenText } from "./handText";

/** Everybody sees who drives by hand, as long as somebody does: above, or on a phone below. */
export function DrivenBy({ place }: { place: "bar" | "line" }) {
  const { drive } = useStop();
  const { yours } = useHand();
  if (drive === null || drive.driven_by === "") return null;
  if (yours && place === "line") return null; // the strip above it says so
  return (
    <span className={classes.driven} data-place={place} data-testid={`driven-by-${place}`}>
      {drivenText(drive.driven_by, yours)}
    </span>
  );
}
