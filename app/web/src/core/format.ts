/** Values as people read them. */

const counts = new Intl.NumberFormat("en-US");
const moments = new Intl.DateTimeFormat("en-US", { dateStyle: "medium", timeStyle: "short" });

export function count(value: number): string {
  return counts.format(value);
}

/** "1 clip", "2 clips". */
export function plural(value: number, one: string, many = `${one}s`): string {
  return `${count(value)} ${value === 1 ? one : many}`;
}

/** Seconds as 4.8 s, or 1:05. */
export function duration(seconds: number | null): string {
  if (seconds === null) return "–";
  if (seconds < 60) return `${seconds.toFixed(1)} s`;
  const whole = Math.round(seconds);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

export function moment(iso: string): string {
  return moments.format(new Date(iso));
}

/** A label as people write it: `left_hand` is "left hand". */
export function label(name: string): string {
  return name.replaceAll("_", " ");
}

export function bytes(size: number): string {
  if (size < 1e3) return `${size} B`;
  if (size < 1e6) return `${(size / 1e3).toFixed(0)} kB`;
  return size < 1e9 ? `${(size / 1e6).toFixed(1)} MB` : `${(size / 1e9).toFixed(1)} GB`;
}
