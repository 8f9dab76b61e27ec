/**
 * Has all of an element seen, and not only the field in it that has the focus. Also for the `ref` of
 * a form that opens inside a list, whose buttons are at its end.
 */
export const broughtIntoView = (element: HTMLElement | null): void =>
  element?.scrollIntoView({ block: "nearest" });
