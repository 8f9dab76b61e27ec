import { UnstyledButton } from "@mantine/core";
import health from "../../health/Health.module.css";
import { useNav } from "../live/RulesNav";
import { FiringList } from "./FiringList";
import classes from "./Firings.module.css";
import { useFirings } from "./useFirings";

const SHOWN = 6;

/** The newest firings, beside the scene. */
export function FiringsPanel() {
  const nav = useNav();
  const { firings, error } = useFirings(SHOWN, null);
  const shown = firings?.filter((firing) => firing.kind === "firing").slice(0, SHOWN) ?? [];
  return (
    <section className={health.panel} aria-label="Firings" data-testid="firings-panel">
      <h2 className={health.title}>Firings</h2>
      {shown.length === 0 ? (
        <p className={health.empty}>
          {error !== null
            ? error.title
            : firings === null
              ? "Nothing heard yet."
              : "No rule has fired yet."}
        </p>
      ) : (
        <div className={classes.compact}>
          <FiringList firings={shown} />
          <UnstyledButton
            className={classes.all}
            onClick={() => nav.go({ at: "firings", rule: null })}
          >
            All firings
          </UnstyledButton>
        </div>
      )}
    </section>
  );
}
