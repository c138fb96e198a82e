/** The state of the page of the models in its address. */
import { choice, text, type Values } from "$/core/query";

export const TABS = {
  recognition: "Recognition",
  persons: "People",
  tasks: "Tasks",
  words: "Words",
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
};
export type ModelsValues = Values<typeof MODELS>;
