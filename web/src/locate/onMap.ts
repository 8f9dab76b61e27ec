import type { Considered } from "../scene/flat/paint";
import type { LocateDraft } from "./useLocateTool";

/** What the flat map shows of an answer: the place that would be set, or the one that is none. */
export function consideredOf(draft: LocateDraft | null): Considered | null {
  if (draft?.check?.here == null || draft.phase === "told") return null;
  const { ok, here, best } = draft.check;
  if (!ok) return { mark: null, way: [], refused: here };
  return { mark: best ?? here, way: [], refused: null };
}
