/** The document of an evaluation as blocks to show, by its kind. */
import { label } from "$/core/format";
import type { Block } from "./blocks";
import { keyposes } from "./keyposes";
import type { Kind } from "./kinds";
import { lowDimensional } from "./low_dimensional";
import { recognition } from "./recognition";
import { retrieval } from "./retrieval";
import { symbols } from "./symbols";
import { words } from "./words";

const BLOCKS: Readonly<Record<Kind, (document: never) => Block[]>> = {
  recognition,
  retrieval,
  words,
  keyposes,
  "low-dimensional": lowDimensional,
  symbols,
};

export function blocksOf(kind: Kind, document: Readonly<Record<string, unknown>>): Block[] {
  const blocks = BLOCKS[kind](document as never);
  const trimmed = (document.trimmed ?? []) as string[];
  if (trimmed.length === 0) return blocks;
  const names = trimmed.map(label).join(", ");
  const lines = [`The results were too large to be kept whole. Left out: ${names}.`];
  return [{ type: "remarks", title: "What is missing", lines }, ...blocks];
}
