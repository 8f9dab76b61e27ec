/**
 * For the `ref` of a form that opens inside a list: all of it is seen, with the buttons at its end,
 * and not only the field that has the focus.
 */
export const broughtIntoView = (form: HTMLElement | null): void =>
  form?.scrollIntoView({ block: "nearest" });
