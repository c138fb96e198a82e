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
