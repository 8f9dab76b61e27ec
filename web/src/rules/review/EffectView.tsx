import type { Effect } from "../../api/ruleTypes";
import classes from "./Review.module.css";

interface Props {
  effect: Effect;
  /** Names of rules by id. */
  names: ReadonlyMap<string, string>;
  done?: boolean;
}

/** What becomes of the rules' memory: holds, cooldowns, counters. */
export function EffectView({ effect, names, done = false }: Props) {
  const { carried, reset, removed, added } = effect;
  const list = (ids: string[]) => ids.map((id) => `"${names.get(id) || id}"`).join(", ");
  return (
    <ul className={classes.effect} data-testid="effect">
      {carried.length > 0 && (
        <li>
          {carried.length === 1
            ? `1 rule ${done ? "went" : "goes"} on as it was`
            : `${carried.length} rules ${done ? "went" : "go"} on as they were`}
          : holds, cooldowns and counters {done ? "were" : "are"} carried.
        </li>
      )}
      {reset.length > 0 && (
        <li>
          {list(reset)} {done ? "started" : "will start"} afresh: changed in what{" "}
          {reset.length === 1 ? "it does" : "they do"}.
        </li>
      )}
      {added.length > 0 && (
        <li>
          {list(added)} {done ? "was" : "will be"} added.
        </li>
      )}
      {removed.length > 0 && (
        <li>
          {list(removed)} {done ? "was" : "will be"} removed.
        </li>
      )}
    </ul>
  );
}
