/** What is to be expected of rules as soon as they are applied. */
import type { Prospect } from "../../api/ruleTypes";

const BY_ITSELF: ReadonlySet<Prospect["fires"]> = new Set(["soon", "with a message", "if silent"]);

/** Whether a rule will stop or move the robot by itself, as things are. */
export const actsAtOnce = (prospect: Prospect): boolean =>
  prospect.acts && BY_ITSELF.has(prospect.fires);

/** The same, where nobody knows yet, too. */
export const mayAct = (prospect: Prospect): boolean =>
  actsAtOnce(prospect) || (prospect.acts && prospect.fires === "unknown");
