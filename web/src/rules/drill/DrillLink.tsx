import { Button } from "@mantine/core";
import type { Drill } from "../../api/drillTypes";
import { useNav } from "../context/RulesNav";
import { progressText } from "./drillText";

/** The way to a drill for who proposes nothing: it runs, or has ended. */
export function DrillLink({ drill }: { drill: Drill | null }) {
  const nav = useNav();
  if (drill === null || nav.place.at === "review") return null;
  if (drill.state !== "running" && drill.state !== "done") return null;
  return (
    <Button
      variant="subtle"
      size="compact-md"
      data-testid="drill-link"
      onClick={() => nav.go({ at: "review" })}
    >
      {drill.state === "done"
        ? `Drill by ${drill.by}`
        : `Drill by ${drill.by}: ${drill.done === 0 ? "it begins" : progressText({ ...drill, left: null })}`}
    </Button>
  );
}
