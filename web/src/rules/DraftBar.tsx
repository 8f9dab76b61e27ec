import { Button } from "@mantine/core";
import { english } from "../texts/language";
import { useRules } from "./context/RulesContext";
import { type Place, useNav } from "./context/RulesNav";
import { DrillLink } from "./drill/DrillLink";
import { ROOM_MS, useDrillRoom } from "./drill/useDrill";
import classes from "./Sheet.module.css";

/** What the robot did and said, which nobody edits. */
const RECORDS: ReadonlySet<Place["at"]> = new Set(["timeline", "log"]);

/** What is not yet on the robot, and the way there and back; nothing where rules are not spoken of. */
export function DraftBar() {
  const { draft, check, mayEdit } = useRules();
  const nav = useNav();
  const records = RECORDS.has(nav.place.at);
  const { data: room } = useDrillRoom(records ? { enabled: false } : { again: ROOM_MS });
  if (records) return null;
  if (!mayEdit) {
    return (
      <div className={classes.draft} data-idle lang={english()}>
        <span className={classes.muted} data-testid="viewer-note">
          Viewers read everything here. To change a rule, log in as an operator.
        </span>
        <DrillLink drill={room?.newest ?? null} />
      </div>
    );
  }
  const count = draft.changes.length;
  if (count === 0) {
    return (
      <div className={classes.draft} data-idle={draft.undo === null || undefined} lang={english()}>
        <span className={classes.muted} data-testid="draft-state">
          No unsaved changes
        </span>
        <DrillLink drill={room?.newest ?? null} />
        {draft.undo !== null && (
          <Button variant="subtle" size="compact-md" onClick={draft.undo} data-testid="draft-undo">
            Undo
          </Button>
        )}
      </div>
    );
  }
  const reviewing = nav.place.at === "review" || nav.place.at === "conflict";
  const errors = check.findings.filter((finding) => finding.level === "error").length;
  return (
    <div className={classes.draft} lang={english()}>
      <strong data-testid="draft-state">
        {count === 1 ? "1 unsaved change" : `${count} unsaved changes`}
        {errors > 0 && `, ${errors === 1 ? "1 problem" : `${errors} problems`}`}
      </strong>
      {draft.undo !== null && (
        <Button variant="subtle" onClick={draft.undo} data-testid="draft-undo">
          Undo
        </Button>
      )}
      <Button
        variant="default"
        onClick={() => {
          draft.discardAll();
          if (reviewing) nav.go({ at: "table" });
        }}
        data-testid="draft-discard"
      >
        Discard
      </Button>
      {/* It keeps its place while it is not there: a second click must not meet another button. */}
      <Button
        style={reviewing ? { visibility: "hidden" } : undefined}
        onClick={() => nav.go({ at: draft.overtaken ? "conflict" : "review" })}
        data-testid="draft-review"
      >
        {draft.overtaken ? "Merge" : "Review & apply"}
      </Button>
    </div>
  );
}
