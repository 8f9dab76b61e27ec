import type { Table } from "../../api/ruleTypes";
import page from "../../ui/page.module.css";
import { useRules } from "../context/RulesContext";
import { Outcome } from "./DrillPanel";
import { wishText } from "./drillText";
import { useDrill } from "./useDrill";

/** The drill that runs, or ran last, for who only looks. */
export function NewestDrill() {
  const { view } = useRules();
  return view === null ? null : <Shown inForce={view.table} />;
}

function Shown({ inForce }: { inForce: Table }) {
  const { drill, fresh } = useDrill(inForce);
  if (drill === null) return null;
  return (
    <section className={page.section} aria-label="Drill" data-testid="drill">
      <h3>Drill: does it recover better?</h3>
      <p className={page.muted}>
        By {drill.by}: {wishText(drill.wish)}.
      </p>
      <Outcome drill={drill} fresh={fresh} />
    </section>
  );
}
