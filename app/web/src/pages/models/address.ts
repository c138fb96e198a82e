/** The state of the page of the models in its address. */
import { choice, list, number, text, type Values } from "$/core/query";
import { GROUPS, KIND_NAMES, type Group } from "./evaluations/kinds";

export const TABS = {
  recognition: "Recognition",
  persons: "People",
  tasks: "Tasks",
  words: "Words",
  evaluations: "Evaluations",
  all: "All models",
} as const;
export type Tab = keyof typeof TABS;

export const FACTORS = { task: "Tasks", person: "Persons" } as const;
export type Factor = keyof typeof FACTORS;

export const MODELS = {
  tab: choice(Object.keys(TABS) as Tab[], "recognition"),
  factor: choice(Object.keys(FACTORS) as Factor[], "task"),
  /** The cell of the confusion matrix whose clips are shown. */
  label: text(),
  guess: text(),
  /** Id of the evaluation that is shown. */
  evaluation: text(),
  /** What to judge next, with its options. */
  kind: choice(KIND_NAMES, "recognition"),
  folder: text(),
  by: choice(Object.keys(GROUPS) as Group[], "none"),
  method: list(),
  rate: number(null, 0, 1),
  nearest: number(null, 1),
  queries: number(null, 1),
  tolerance: number(null, 0, 1),
};
export type ModelsValues = Values<typeof MODELS>;
