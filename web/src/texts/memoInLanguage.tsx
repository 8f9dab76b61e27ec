// biome-ignore lint/style/noRestrictedImports: this is what the others use
import { type ComponentType, memo } from "react";
import { language } from "./language";
import { units } from "./units";

/**
 * `memo` for what holds texts: drawn again when its props have changed, or the language or the units
 * of the page, which React knows nothing of.
 */
export function memoInLanguage<Props extends object>(Component: ComponentType<Props>) {
  return memo(function InItsLanguage(props: Props) {
    language.use();
    units.use();
    return <Component {...props} />;
  });
}
