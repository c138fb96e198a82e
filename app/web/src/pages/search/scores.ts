/** The scores of the parts of a query for one hit, with the names of the parts. */
import type { Schemas } from "$/api/client";
import type { Example } from "./parts";
import { partText } from "./parts";
import { wordOf } from "./words";

export interface PartScore {
  readonly key: string;
  readonly name: string;
  readonly isAgainst: boolean;
  readonly score: number;
}

/** What a query is made of, in the order in which the API was asked. */
export interface QueryParts {
  readonly examples: readonly Example[];
  readonly words: readonly string[];
  readonly file: string;
}

/** nameOf: the name of a clip by its id. */
export function namedScores(
  parts: readonly Pick<Schemas["PartScore"], "part" | "against" | "score">[],
  query: QueryParts,
  nameOf: (id: string) => string,
): readonly PartScore[] {
  return parts.map(({ part, against, score }) => {
    const name = nameOfPart(part, query, nameOf);
    return { key: part, name, isAgainst: against, score };
  });
}

function nameOfPart(part: string, query: QueryParts, nameOf: (id: string) => string): string {
  const [kind, place = ""] = part.split(".");
  if (kind === "file") return query.file;
  if (kind === "poses" || kind === "rhythm") return kind === "poses" ? "Pose" : "Rhythm";
  if (kind === "words") return wordOf(query.words[Number(place)] ?? "").text || part;
  const example = query.examples[Number(place)];
  return example ? [nameOf(example.id), partText(example)].filter(Boolean).join(", ") : part;
}
