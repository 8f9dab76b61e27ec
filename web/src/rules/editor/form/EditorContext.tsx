import { createContext, useContext } from "react";
import type { Finding, Graph } from "../../../api/ruleTypes";

/** What every part of the form needs: what there is to choose from, and what is wrong where. */
export interface Editor {
  graph: Graph | null;
  findings: readonly Finding[];
}

const EditorContext = createContext<Editor | null>(null);
export const EditorProvider = EditorContext.Provider;

export function useEditor(): Editor {
  const editor = useContext(EditorContext);
  if (editor === null) throw new Error("useEditor needs an EditorProvider above it");
  return editor;
}
