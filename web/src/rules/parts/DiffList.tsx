import { useState } from "react";
import type { RuleChange } from "../../api/ruleTypes";
import page from "../../ui/page.module.css";
import classes from "./DiffList.module.css";

const KIND_WORDS: Record<RuleChange["kind"], string> = {
  added: "new",
  removed: "deleted",
  changed: "changed",
  moved: "moved",
};

/** What differs, rule by rule; each opens to its fields. */
export function DiffList({ changes }: { changes: readonly RuleChange[] }) {
  if (changes.length === 0) return <p className={page.muted}>No difference.</p>;
  return (
    <ul className={classes.diff} data-testid="diff">
      {changes.map((change) => (
        <Change key={`${change.rule_id} ${change.kind}`} change={change} />
      ))}
    </ul>
  );
}

function Change({ change }: { change: RuleChange }) {
  const [open, setOpen] = useState(false);
  return (
    <li>
      <div className={classes.changeHead}>
        <span className={classes.kind} data-kind={change.kind}>
          {KIND_WORDS[change.kind]}
        </span>
        <strong>{change.name || change.rule_id}</strong>
        {!change.semantic && <span className={page.muted}>does the same as before</span>}
      </div>
      <p className={classes.summary}>{change.summary}</p>
      {change.fields.length > 0 && (
        <>
          <button
            type="button"
            className={page.more}
            aria-expanded={open}
            onClick={() => setOpen(!open)}
          >
            {open ? "Hide the fields" : "Field by field"}
          </button>
          {open && (
            <table className={classes.fields}>
              <thead>
                <tr>
                  <th scope="col">Field</th>
                  <th scope="col">Before</th>
                  <th scope="col">After</th>
                </tr>
              </thead>
              <tbody>
                {change.fields.map(({ field, before, after }) => (
                  <tr key={field}>
                    <th scope="row">{field}</th>
                    <td>{plain(before)}</td>
                    <td>{plain(after)}</td>
                  </tr>
                ))}
              </tbody>
            </table>
          )}
        </>
      )}
    </li>
  );
}

function plain(value: unknown): string {
  if (value === null || value === undefined) return "–";
  return typeof value === "string" ? value : JSON.stringify(value);
}
