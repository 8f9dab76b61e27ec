import { UnstyledButton } from "@mantine/core";
import { t } from "../../texts/text";
import { useRules } from "../context/RulesContext";
import { useNav } from "../context/RulesNav";
import { leftText } from "../model/words";
import classes from "./RevisionBadge.module.css";
import { useProbation } from "./useProbation";

/** The revision in force, in the top bar: kept, or still on probation and for how long. */
export function RevisionBadge() {
  const probation = useProbation();
  const { draft } = useRules();
  const nav = useNav();
  if (probation === null) return null;
  const { revision, confirmed, left, available } = probation;
  const state = !available
    ? t("silent")
    : left > 0
      ? `▲ ${t("probation {left}", { left: leftText(left) })}`
      : revision === confirmed
        ? `✓ ${t("confirmed")}`
        : t("not confirmed");
  const unsaved = draft.changes.length;
  return (
    <UnstyledButton
      className={classes.badge}
      data-probation={left > 0 || undefined}
      data-unsaved={unsaved > 0 || undefined}
      data-silent={!available || undefined}
      data-testid="revision-badge"
      title={t("Open the rules (R)")}
      onClick={() => nav.go(nav.place)}
    >
      <span className={classes.revision}>{t("rev {revision}", { revision })}</span>{" "}
      <span className={classes.state}>{state}</span>
      {unsaved > 0 && (
        <span className={classes.unsaved} title={t("Unsaved changes")}>
          ✎ {unsaved}
          <span className="visually-hidden"> {t("unsaved changes")}</span>
        </span>
      )}
    </UnstyledButton>
  );
}
