import type { ApplyReport } from "../../api/ruleTypes";
import type { Probation } from "../bands/useProbation";

/** Where a table that was applied stands by now. */
export type Standing =
  | { is: "probation"; left: number }
  | { is: "kept" }
  | { is: "replaced"; by: number };

/**
 * As the robot tells it. Its word may be older than the report: then the report counts, for
 * revisions only ever grow.
 */
export function standing(
  report: Pick<ApplyReport, "revision" | "probation">,
  live: Pick<Probation, "revision" | "left"> | null,
): Standing {
  if (live === null || live.revision < report.revision)
    return report.probation > 0 ? { is: "probation", left: report.probation } : { is: "kept" };
  if (live.revision > report.revision) return { is: "replaced", by: live.revision };
  return live.left > 0 ? { is: "probation", left: Math.ceil(live.left) } : { is: "kept" };
}
