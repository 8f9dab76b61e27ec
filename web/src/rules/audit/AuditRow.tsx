import type { AuditLine } from "../../api/types";
import { whenText } from "../model/words";
import classes from "./Audit.module.css";
import { detailsText, failed } from "./auditText";

/** One deed. On a phone its cells stand one below the other. */
export function AuditRow({ line, now }: { line: AuditLine; now: number }) {
  const details = detailsText(line.details);
  return (
    <tr data-testid={`audit-${line.seq}`} data-failed={failed(line.outcome) || undefined}>
      <td className={classes.when}>
        <time dateTime={line.time} title={line.time}>
          {whenText(Date.parse(line.time) / 1000, now)}
        </time>
      </td>
      <td className={classes.who}>
        {line.who}
        {line.role !== "" && line.role !== line.who && (
          <span className={classes.role} title={line.session && `log-in ${line.session}`}>
            {line.role === "none" ? "not logged in" : line.role}
          </span>
        )}
      </td>
      <td>{line.what}</td>
      <td className={classes.outcome}>
        {line.outcome}
        {details !== "" && <span className={classes.details}>{details}</span>}
      </td>
      <td className={classes.from}>{line.address}</td>
    </tr>
  );
}
