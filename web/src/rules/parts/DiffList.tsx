import { useState } from "react";
import type { Rule, RuleChange } from "../../api/ruleTypes";
import page from "../../ui/page.module.css";
import { wholeRule } from "../model/ruleLines";
import { useNames } from "../model/useNames";
import classes from "./DiffList.module.css";
import { InWords } from "./InWords";

const KIND_WORDS: Record<RuleChange["kind"], string> = {
  added: "new",
  removed: "deleted",
  changed: "changed",
  moved: "moved",
};

interface Props {
  changes: readonly RuleChange[];
  /** The rules of both tables, where they are at hand: new and deleted ones are then told in full. */
  rules?: readonly Rule[];
}

/** What differs, rule by rule; each opens to its fields. */
export function DiffList({ changes, rules = [] }: Props) {
  if (changes.length === 0) return <p className={page.muted}>No difference.</p>;
  return (
    <ul className={classes.diff} data-testid="diff">
      {changes.map((change) => (
        <Change
          key={`${change.rule_id} ${change.kind}`}
          change={change}
          rule={rules.find(({ id }) => id === change.rule_id)}
        />
      ))}
    </ul>
  );
}

function Change({ change, rule }: { change: RuleChange; rule: Rule | undefined }) {
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
      <p className={classes.summary}>
        <Summary change={change} rule={rule} />
      </p>
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

function Summary({ change, rule }: { change: RuleChange; rule: Rule | undefined }) {
  const names = useNames();
  const isWhole = change.kind === "added" || change.kind === "removed";
  if (!isWhole || rule === undefined) return change.summary;
  return <InWords {...wholeRule(rule, names)} />;
}

function plain(value: unknown): string {
  if (value === null || value === undefined) return "–";
  return typeof value === "string" ? value : JSON.stringify(value);
}
