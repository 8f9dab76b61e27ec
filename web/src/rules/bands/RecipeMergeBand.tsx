import { Button } from "@mantine/core";
import type { TableView } from "../../api/ruleTypes";
import { t } from "../../texts/text";
import { Band } from "../../ui/Band";
import { beginDraft } from "../changes/draft";
import { useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";

/** Edits of an older recipe wait to be laid over the new one. */
export function RecipeMergeBand({ merge }: { merge: NonNullable<TableView["merge"]> }) {
  const { view, draft } = useRules();
  const nav = useNav();
  const take = () => {
    if (view === null) return;
    draft.take({
      ...beginDraft(view.robot, view.revision, view.table),
      table: merge.table,
      reason: `Edits of revision ${merge.revision} on the new recipe`,
    });
    nav.go({ at: "review" });
  };
  return (
    <Band
      tone="notice"
      testId="merge-band"
      title={t("The recipe has changed since the rules were edited.")}
      action={
        draft.draft === null ? (
          <Button onClick={take} data-testid="merge-take">
            {t("Review the merge")}
          </Button>
        ) : undefined
      }
    >
      {t(
        "The recipe's rules are in force; the edits of revision {revision} are kept and can be laid over them.",
        { revision: merge.revision },
      )}
      {merge.conflicts.map((conflict) => (
        <div key={conflict}>{conflict}</div>
      ))}
    </Band>
  );
}
