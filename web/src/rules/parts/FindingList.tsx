import type { Finding } from "../../api/ruleTypes";
import { StatusMark } from "../../ui/StatusMark";
import { sentence } from "../model/words";
import classes from "./FindingList.module.css";

/** What is wrong, or to think about, right where it is; nothing when all is well. */
export function FindingList({ findings }: { findings: readonly Finding[] }) {
  if (findings.length === 0) return null;
  return (
    <ul className={classes.findings} data-testid="findings">
      {findings.map((finding) => (
        <li
          key={`${finding.code} ${finding.rule_id} ${finding.field} ${finding.text}`}
          data-level={finding.level}
        >
          <StatusMark level={finding.level === "error" ? "failed" : "degraded"} />
          <span>
            <span className="visually-hidden">
              {finding.level === "error" ? "Error: " : "To think about: "}
            </span>
            {sentence(finding.text)}{" "}
            <span className={classes.remedy}>{sentence(finding.remedy)}</span>
          </span>
        </li>
      ))}
    </ul>
  );
}
