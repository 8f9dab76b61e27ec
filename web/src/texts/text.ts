import { IntlMessageFormat } from "intl-messageformat";
import type { ReactNode } from "react";
import { GERMAN, type Text } from "./german";
import { type Language, language } from "./language";

export type { Text };

/** A text that has nothing to fill in. */
export type Phrase = Exclude<Text, `${string}{${string}`>;

/** What stands in for `{name}` and `{name, plural, …}` of a text. */
type NamesIn<Message extends string> = Message extends `${string}{${infer Rest}`
  ? Plain<Before<Rest, "}">> | Plain<Before<Rest, ", plural">> | NamesIn<Rest>
  : never;
type Before<Text extends string, End extends string> = Text extends `${infer Name}${End}${string}`
  ? Name
  : never;
/** Not what is said of one or of many. */
type Plain<Name extends string> = Name extends `${string}${" " | "#" | "{" | "}" | ","}${string}`
  ? never
  : Name;

type Values<Message extends string, Value> = [NamesIn<Message>] extends [never]
  ? []
  : [values: Record<NamesIn<Message>, Value>];

const formats = new Map<string, IntlMessageFormat>();

/** The message of a text in a language, read once. */
export function formatOf(text: Text, of: Language): IntlMessageFormat {
  const key = `${of} ${text}`;
  let format = formats.get(key);
  if (format === undefined) {
    format = new IntlMessageFormat(of === "de" ? GERMAN[text] : text, of);
    formats.set(key, format);
  }
  return format;
}

/**
 * A text in the language of the page.
 *
 * The English text is its own key: it reads at the place where it stands, and the catalogues in
 * `german/` say it in German. They are the type of `text`, so none can be forgotten.
 */
export function t<Message extends Text>(
  text: Message,
  ...values: Values<Message, string | number>
): string {
  return textIn(language.get(), text, ...values);
}

/** A text in one language, whatever that of the page is. */
export function textIn<Message extends Text>(
  of: Language,
  text: Message,
  ...[values]: Values<Message, string | number>
): string {
  return String(formatOf(text, of).format(values ?? {}));
}

/** The same with parts that are more than words: `{name}`, and `<a>…</a>` for what is drawn around. */
export function rich<Message extends Text>(
  text: Message,
  values: Record<string, ReactNode | ((parts: ReactNode[]) => ReactNode)>,
): ReactNode {
  return formatOf(text, language.get()).format<ReactNode>(values as Record<string, ReactNode>);
}
