/** What to expect of a motion that nobody recorded, in sentences. */
import type { Schemas } from "$/api/client";
import { label, plural } from "$/core/format";

type Quality = Schemas["Quality"];

const percent = (share: number): string => `${Math.round(share * 100)} %`;

/** How somebody is called of whom there are only clips without a name. */
export const NAMELESS = "this person";

const capital = (text: string): string =>
  text === NAMELESS ? text.charAt(0).toUpperCase() + text.slice(1) : text;

export function inSentences(quality: Quality, person: string, task: string): readonly string[] {
  return [
    origin(quality, person, task),
    nearest(quality),
    expected(quality),
    skate(quality),
    ...quality.warnings.map(({ detail }) => `Warning: ${detail}`),
  ].filter((sentence) => sentence !== "");
}

function origin(
  { kind, given_persons: persons, given_tasks: tasks, follows }: Quality,
  person: string,
  task: string,
): string {
  if (kind === "seen") return `${capital(person)} did this task: it is made of the takes of it.`;
  const learned = `It is made of ${plural(persons.length, "person", "persons")} who did "${label(task)}", and of ${plural(tasks.length, "task")} that ${person} did.`;
  return follows
    ? `${learned} It follows the take of ${follows}, since takes of it differ much.`
    : learned;
}

function nearest({
  nearest_person: person,
  nearest_task: task,
  task_is_right: isTask,
  person_is_right: isPerson,
}: Quality): string {
  const found = `The nearest real clip shows ${person}, ${label(task)}`;
  if (!isTask) return `${found}: another task. Do not trust this motion.`;
  return isPerson === false ? `${found}: the task is right, the person is another.` : `${found}.`;
}

function expected({ expected_hit: hit, expected_trials: trials, real_hit: real }: Quality): string {
  if (hit === null || trials === null) return "";
  const bound = real === null ? "" : ` Real takes reach ${percent(real)}.`;
  return `About ${percent(hit)} of such motions are nearest to a real take of the same person and task, judged by ${trials} that were held out.${bound}`;
}

function skate({ skate: own, real_skate: real }: Quality): string {
  const speed = (metersPerSecond: number): string => `${(metersPerSecond * 100).toFixed(0)} cm/s`;
  const compared = real === null ? "" : `, in real takes ${speed(real)}`;
  return `Feet near the floor slide at ${speed(own)}${compared}.`;
}
