/** The words of a query: each is asked for, or has a minus and leaves clips out. */

export interface Word {
  readonly text: string;
  readonly isMinus: boolean;
}

export function wordOf(written: string): Word {
  const trimmed = written.trim();
  const isMinus = trimmed.startsWith("-");
  return { text: isMinus ? trimmed.slice(1).trim() : trimmed, isMinus };
}

export function written({ text, isMinus }: Word): string {
  return isMinus ? `-${text}` : text;
}

/** With a word more; one that is there already gets the new sign. */
export function withWord(words: readonly string[], typed: string): readonly string[] {
  const word = wordOf(typed);
  if (word.text === "") return words;
  return [...withoutWord(words, word.text), written(word)];
}

export function withoutWord(words: readonly string[], text: string): readonly string[] {
  return words.filter((other) => wordOf(other).text !== text);
}

/** With the other sign for one word. */
export function withOtherSign(words: readonly string[], text: string): readonly string[] {
  return words.map((other) => {
    const word = wordOf(other);
    return word.text === text ? written({ text, isMinus: !word.isMinus }) : other;
  });
}
