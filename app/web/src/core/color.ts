/** Colors as red, green and blue, 0 to 255. */
export type Rgb = readonly [number, number, number];

/** Of `rgb(1 2 3)`, as browsers give a computed color. */
export function rgb(color: string): Rgb {
  const [red = 0, green = 0, blue = 0] = (color.match(/[\d.]+/g) ?? []).map(Number);
  return [red, green, blue];
}

/** The color at a share, 0 to 1, of the way through others. */
export function between(colors: readonly Rgb[], share: number): Rgb {
  const at = Math.min(Math.max(0, share), 1) * (colors.length - 1);
  const before = Math.min(Math.floor(at), colors.length - 2);
  const [from, to] = [colors[before] ?? [0, 0, 0], colors[before + 1] ?? [0, 0, 0]];
  const mixed = (axis: 0 | 1 | 2): number => from[axis] + (at - before) * (to[axis] - from[axis]);
  return [mixed(0), mixed(1), mixed(2)];
}
