/** Why a clip is a hit: what is asked, and what the answer is made of. */
import { api, ask, type Clip, type Schemas } from "$/api/client";
import { ApiProblem } from "$/api/problem";
import type { Line } from "$/ui/lines";
import type { Asked } from "../address";
import { composedOf, isForSomething, isOfWholeClips, partsOf, sendComposed } from "../composed";
import { namedScores, type QueryParts } from "../scores";

type HitReasons = Schemas["HitReasons"];
type Reason = Schemas["HitReason"];

export interface Explained {
  readonly reasons: HitReasons;
  readonly query: QueryParts;
  readonly hit: Clip;
  /** The clips of the examples that are there, by id. */
  readonly clips: ReadonlyMap<string, Clip>;
}

/** One part of a query: its name, and what it says. */
export interface NamedReason {
  readonly name: string;
  readonly reason: Reason;
  /** The clip of the example; null for words and for a file. */
  readonly example: Clip | null;
}

/** Whether the API can say why a clip is a hit: parts of clips are only hits of words. */
export function hasReasons(asked: Asked): boolean {
  return isForSomething(asked) && (isOfWholeClips(asked) || asked.kind === "words");
}

/** file: the one that is a part of the query. Throws ApiProblem, Away, AbortError. */
export async function explain(
  asked: Asked,
  file: File | null,
  hit: string,
  signal: AbortSignal,
): Promise<Explained> {
  const composed = await composedOf(asked, signal);
  const query = partsOf(composed, file?.name ?? "");
  const ids = [...new Set(query.examples.map(({ id }) => id))];
  const body = { ...composed, hit };
  const [reasons, own, ...examples] = await Promise.all([
    sendComposed<HitReasons>("/v1/search/why", body, file, signal),
    clipOf(hit, signal),
    ...ids.map((id) => exampleOf(id, signal)),
  ]);
  const clips = new Map(
    examples.filter((clip) => clip !== null).map((clip): [string, Clip] => [clip.id, clip]),
  );
  return { reasons, query, hit: own, clips };
}

function clipOf(id: string, signal: AbortSignal): Promise<Clip> {
  return ask(api.GET("/v1/clips/{clip_id}", { params: { path: { clip_id: id } }, signal }));
}

/** What is wrong with an example, the reasons say. */
async function exampleOf(id: string, signal: AbortSignal): Promise<Clip | null> {
  try {
    return await clipOf(id, signal);
  } catch (failure) {
    if (failure instanceof ApiProblem) return null;
    throw failure;
  }
}

/** The parts of a query with their names, in the order of the answer. */
export function namedReasons({ reasons, query, clips }: Explained): readonly NamedReason[] {
  const names = namedScores(reasons.parts, query, (id) => clips.get(id)?.name ?? id);
  return reasons.parts.map((reason, place) => {
    const [kind, index = ""] = reason.part.split(".");
    const id = kind === "examples" ? query.examples[Number(index)]?.id : undefined;
    return {
      name: names[place]?.name ?? reason.part,
      reason,
      example: clips.get(id ?? "") ?? null,
    };
  });
}

/** The part that is shown first: an example for something, else the first. */
export function firstPart(parts: readonly NamedReason[]): string {
  const shown = parts.find(({ reason }) => reason.alignment && !reason.against) ?? parts[0];
  return shown?.reason.part ?? "";
}

/** The parts' shares of what they cost together, 0 to 1. */
export function sharesOfCost(parts: readonly Pick<Reason, "cost">[]): readonly number[] {
  const total = parts.reduce((sum, { cost }) => sum + cost, 0);
  return parts.map(({ cost }) => (total > 0 ? cost / total : 0));
}

/** The curves of words over the time of the hit. */
export function wordLines(parts: readonly NamedReason[]): readonly Line[] {
  return parts.flatMap(({ name, reason: { curve, against } }) =>
    curve
      ? [
          {
            name: against ? `${name} (against)` : name,
            points: curve.times.map((time, at) => [time, curve.values[at] ?? 0] as const),
          },
        ]
      : [],
  );
}

/** When a line is highest. */
export function highest({ points }: Line): readonly [seconds: number, value: number] {
  return points.reduce((best, point) => (point[1] > best[1] ? point : best), [0, 0]);
}
