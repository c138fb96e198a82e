/** How hits can be arranged: their order, groups, least score and diversity. */

/** The orders of hits: by their scores, or by a measure that each clip tells. */
export const ORDERS = {
  best: "Best first",
  "-duration": "Longest first",
  duration: "Shortest first",
  "-speed": "Fastest first",
  speed: "Slowest first",
  "-travel": "Farthest first",
  "-energy": "Most energy first",
  energy: "Least energy first",
  "-tempo": "Highest tempo first",
} as const;
export type Order = keyof typeof ORDERS;

/** Groups of which only the best hit is shown. */
export const GROUPS = {
  "": "Every hit",
  person: "Best of each person",
  task: "Best of each task",
  source: "Best of each source",
  duplicates: "Best of near-duplicates",
} as const;
export type GroupName = keyof typeof GROUPS;

/** Scores that hits can be asked to have at least. */
export const LEAST_SCORES = [0.25, 0.5, 0.75, 0.9] as const;
/** How much unlikeness counts in a diverse list; the rest is the score. */
export const DIVERSITY = 0.5;

/** What the API is asked for; without a member, hits are not arranged by it. */
export interface Arrangement {
  readonly group_by?: Exclude<GroupName, "">;
  readonly diversity?: number;
  readonly min_score?: number;
}

export function arrangementOf({
  group_by,
  diverse,
  least,
}: {
  group_by: GroupName;
  diverse: boolean;
  least: number | null;
}): Arrangement {
  return {
    ...(group_by && { group_by }),
    ...(diverse && { diversity: DIVERSITY }),
    ...(least && { min_score: least }),
  };
}
