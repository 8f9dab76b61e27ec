import { UnstyledButton } from "@mantine/core";
import { t } from "../../texts/text";
import { Panel } from "../../ui/Panel";
import { useNav } from "../context/RulesNav";
import { FiringList } from "./FiringList";
import classes from "./Firings.module.css";
import { useFirings } from "./useFirings";

const SHOWN = 6;

/** The newest firings, beside the scene. */
export function FiringsPanel() {
  const nav = useNav();
  const { firings, error } = useFirings(SHOWN, null);
  const shown = firings?.filter((firing) => firing.kind === "firing").slice(0, SHOWN) ?? [];
  const none = firings === null ? t("Nothing heard yet.") : t("No rule has fired yet.");
  return (
    <Panel
      title={t("Firings")}
      testId="firings-panel"
      empty={shown.length === 0 ? (error?.title ?? none) : null}
    >
      <div className={classes.compact}>
        <FiringList firings={shown} />
        <UnstyledButton
          className={classes.all}
          onClick={() => nav.go({ at: "firings", rule: null })}
        >
          {t("All firings")}
        </UnstyledButton>
      </div>
    </Panel>
  );
}
