/** The state of the page of the models in its address. */
import { choice, list, number, text, type Values } from "$/core/query";
import { PLAYER } from "$/player/view";
import { GROUPS, KIND_NAMES, type Group } from "./evaluations/kinds";

export const TABS = {
  recognition: "Recognition",
  persons: "People",
  signatures: "Signatures",
  tasks: "Tasks",
  words: "Words",
  evaluations: "Evaluations",
  all: "All models",
} as const;
export type Tab = keyof typeof TABS;

export const FACTORS = { task: "Tasks", person: "Persons" } as const;
export type Factor = keyof typeof FACTORS;

/** Models that have signatures, by kind. */
export const SIGNATURE_MODELS = {
  signatures: "Joint angles",
  multilinear: "Positions of joints",
} as const;
export type SignatureModel = keyof typeof SIGNATURE_MODELS;
const MAX_EIGENMOTIONS = 100;
const MAX_DEVIATIONS = 6;

export const MODELS = {
  ...PLAYER,
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
  /** The model whose signatures are shown, the eigenmotion that is played, and how far from the
      mean motion, in standard deviations. */
  model: choice(Object.keys(SIGNATURE_MODELS) as SignatureModel[], "signatures"),
  eigenmotion: number(1, 1, MAX_EIGENMOTIONS),
  deviations: number(2, 0, MAX_DEVIATIONS),
  /** The clips of the table come after this cursor. */
  after: text(),
};
export type ModelsValues = Values<typeof MODELS>;
