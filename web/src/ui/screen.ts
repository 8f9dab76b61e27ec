/** A screen on which the rules take the place of the scene: a phone, upright or on its side. */
export const PHONE = "(max-width: 560px), (max-width: 1100px) and (max-height: 500px)";
/** One on which the tools lie in a row over the scene: there is no height for a column. */
export const LOW = "(max-width: 560px), (max-width: 1100px) and (max-height: 760px)";
