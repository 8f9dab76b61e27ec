import { DRIVE } from "./drive";
import { FRAME } from "./frame";
import { HAPPENINGS } from "./happenings";
import { LISTS } from "./lists";
import { LOOK } from "./look";
import { ROBOT } from "./robot";

/** Every text of the page: in English, its key, and in German. */
export const GERMAN = { ...DRIVE, ...FRAME, ...HAPPENINGS, ...LISTS, ...LOOK, ...ROBOT };

/** A text of the page, by what it says in English. */
export type Text = keyof typeof GERMAN;
