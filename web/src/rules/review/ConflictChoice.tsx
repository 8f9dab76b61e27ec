import type { ReactNode } from "react";
import type { Rule, Table } from "../../api/ruleTypes";
import { type Choice, type Difference, fieldSides, type Side } from "../changes/conflict";
import { ruleOf } from "../changes/draft";
import type { RuleField } from "../changes/ruleFields";
import classes from "./Review.module.css";

const SIDES: readonly Side[] = ["mine", "theirs"];
const SIDE_WORDS: Record<Side, string> = { mine: "Mine", theirs: "Theirs" };

interface Props {
  difference: Difference;
  choice: Choice | null;
  tables: Record<Side, Table>;
  onChoose: (choice: Choice) => void;
}

/** One rule that two people changed: mine, theirs, or some fields of each. */
export function ConflictChoice({ difference, choice, tables, onChoose }: Props) {
  const { id, name, both, fields } = difference;
  const changes = { mine: difference.mine, theirs: difference.theirs };
  const mine = ruleOf(tables.mine, id);
  const theirs = ruleOf(tables.theirs, id);
  const byField = choice !== null && typeof choice === "object";
  return (
    <div className={classes.conflict} data-testid={`conflict-${id}`}>
      <strong>{name}</strong>
      <fieldset className={classes.sides} aria-label={name}>
        {SIDES.map((side) => (
          <SideButton
            key={side}
            on={choice === side}
            testId={`keep-${side}`}
            onClick={() => onChoose(side)}
            title={SIDE_WORDS[side]}
          >
            {changes[side]?.summary ?? "as it was"}
          </SideButton>
        ))}
        {both && fields.length > 1 && (
          <SideButton
            on={byField}
            testId="keep-fields"
            wide
            onClick={() => onChoose(byField ? choice : fieldSides(difference))}
            title="Some of each"
          >
            choose for each of the {fields.length} fields
          </SideButton>
        )}
      </fieldset>
      {byField && mine !== null && theirs !== null && (
        <div className={classes.fieldChoices}>
          {fields.map(({ field }) => (
            <FieldChoice
              key={field.key}
              field={field}
              versions={{ mine, theirs }}
              side={choice[field.key] ?? null}
              onChoose={(side) => onChoose({ ...choice, [field.key]: side })}
            />
          ))}
        </div>
      )}
    </div>
  );
}

interface FieldProps {
  field: RuleField;
  versions: Record<Side, Rule>;
  side: Side | null;
  onChoose: (side: Side) => void;
}

function FieldChoice({ field, versions, side, onChoose }: FieldProps) {
  return (
    <div className={classes.fieldChoice} data-testid={`field-${field.key}`}>
      <span>{field.label}</span>
      <fieldset className={classes.sides} aria-label={field.label}>
        {SIDES.map((each) => (
          <SideButton
            key={each}
            on={side === each}
            testId={`field-${each}`}
            onClick={() => onChoose(each)}
            title={SIDE_WORDS[each]}
          >
            {field.tell(versions[each])}
          </SideButton>
        ))}
      </fieldset>
    </div>
  );
}

function SideButton(props: {
  title: string;
  on: boolean;
  wide?: boolean;
  testId: string;
  onClick: () => void;
  children: ReactNode;
}) {
  const { title, on, wide = false, testId, onClick, children } = props;
  return (
    <button
      type="button"
      aria-pressed={on}
      className={classes.side}
      data-wide={wide || undefined}
      data-testid={testId}
      onClick={onClick}
    >
      <strong>
        {on ? "◉" : "○"} {title}
      </strong>
      {children}
    </button>
  );
}
