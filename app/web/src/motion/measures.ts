/** The measures of clips, as the API names them, with what people read. */
export const MEASURES = {
  duration: { title: "Duration", unit: "s" },
  travel: { title: "Way", unit: "m" },
  speed: { title: "Speed", unit: "m/s" },
  energy: { title: "Energy", unit: "body lengths/s" },
  tempo: { title: "Tempo", unit: "beats/min" },
  frame_rate: { title: "Frame rate", unit: "Hz" },
  joints: { title: "Joints", unit: "" },
} as const;
export type Measure = keyof typeof MEASURES;
export const MEASURE_NAMES = Object.keys(MEASURES) as Measure[];

/** "Speed, m/s" */
export function titleOf(measure: Measure): string {
  const { title, unit } = MEASURES[measure];
  return unit ? `${title}, ${unit}` : title;
}

/** "1.42 m/s"; null where there is none. */
export function measured(measure: Measure, value: number | null): string | null {
  if (value === null) return null;
  const { unit } = MEASURES[measure];
  return `${Number(value.toPrecision(3))} ${unit}`.trim();
}

/** What people read of any measure that the API names: "foot_skate" is "Foot skate". */
export function titleOfName(name: string): string {
  const words = name.replaceAll("_", " ");
  return name in MEASURES
    ? MEASURES[name as Measure].title
    : words.charAt(0).toUpperCase() + words.slice(1);
}

/** A value with its unit in few digits; shares as percent. */
export function figure(value: number, unit: string): string {
  if (unit === "share") return `${Number((100 * value).toPrecision(2))} %`;
  const isSmall = Math.abs(value) < 0.0005;
  const number = isSmall ? 0 : Number(value.toPrecision(3));
  const isBare = unit === "" || unit === "log" || unit.includes("..");
  return isBare ? String(number) : `${number} ${unit}`;
}
