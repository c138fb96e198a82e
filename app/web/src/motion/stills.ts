/** Still pictures of clips: the server's, in the colors of the theme, kept while they may be seen. */
import { askFor } from "$/api/client";
import { Kept } from "$/core/kept";
import { Turns } from "$/core/pool";

const MAX_KEPT = 600;
/** Browsers keep six connections to a server: the rest is for what the reader does. */
const MAX_AT_ONCE = 4;
/** What the server draws with, and our tokens in its place. */
const DARK: Readonly<Record<string, string>> = {
  "#2b3440": "#dcd8cf",
  "#c2622d": "#ee9463",
  "#1f6f8b": "#6fbcd8",
  "#d5cfc2": "#3a4147",
};
const PAPER = /<rect [^>]*fill="#f6f4ef"\/>/;

const turns = new Turns(MAX_AT_ONCE);
const kept = new Kept<string, string>(MAX_KEPT);

/** The address of a clip's picture. Throws ApiProblem, Away, AbortError. */
export async function stillOf(
  clipId: string,
  isDark: boolean,
  signal: AbortSignal,
): Promise<string> {
  const svg = kept.get(clipId) ?? (await turns.take(() => fetched(clipId, signal), signal));
  kept.set(clipId, svg);
  return URL.createObjectURL(new Blob([colored(svg, isDark)], { type: "image/svg+xml" }));
}

async function fetched(clipId: string, signal: AbortSignal): Promise<string> {
  const path = `/v1/clips/${encodeURIComponent(clipId)}/thumbnail.svg`;
  return (await askFor(path, { signal })).text();
}

/** Without its paper, so that the card's own shows, and with colors that suit it. */
export function colored(svg: string, isDark: boolean): string {
  const without = svg.replace(PAPER, "");
  if (!isDark) return without;
  return Object.entries(DARK).reduce((text, [from, to]) => text.replaceAll(from, to), without);
}
