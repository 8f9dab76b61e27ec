import { createContext, useContext } from "react";
import type { Finding, Graph, LeafReading } from "../../api/ruleTypes";

/** What every part of the form needs: what there is to choose from, and what is wrong where. */
export interface Editor {
  graph: Graph | null;
  findings: readonly Finding[];
  /** How the leaves are judged right now, by the place of their tree and their path in it. */
  reading: (root: string, path: readonly number[]) => LeafReading | null;
}

const EditorContext = createContext<Editor | null>(null);
export const EditorProvider = EditorContext.Provider;

export function useEditor(): Editor {
  const editor = useContext(EditorContext);
  if (editor === null) throw new Error("useEditor needs an EditorProvider above it");
  return editor;
}
