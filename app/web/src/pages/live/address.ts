/** What the page of the work shows, in its address. */
import { choice, text } from "$/core/query";

export const KINDS = {
  any: "All",
  import: "Imports",
  ingest: "Analyses",
  fit: "Fits",
  evaluate: "Evaluations",
} as const;
export type Kind = keyof typeof KINDS;

export const LIVE = {
  kind: choice(Object.keys(KINDS) as Kind[], "any"),
  /** Id of the import whose files are shown. */
  job: text(),
};

const TITLES: Readonly<Record<string, string>> = {
  import: "Import",
  ingest: "Analysis",
  fit: "Fit of the models",
  evaluate: "Evaluation",
};
export const jobTitle = (kind: string): string => TITLES[kind] ?? kind;

/** The result of a job in few words: of an import the number of files by outcome. */
export function summary(result: Readonly<Record<string, unknown>> | null): string {
  const outcomes = ["new", "updated", "unchanged", "conflicting", "failed", "skipped"];
  const counts = outcomes.flatMap((outcome) => {
    const count = result?.[outcome];
    return typeof count === "number" && count > 0 ? [`${count} ${outcome}`] : [];
  });
  return counts.join(", ");
}
