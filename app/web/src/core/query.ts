/**
 * The typed state of a page in the query of its address.
 *
 * A page names its fields once; a field knows how to read and write its values. What equals the
 * field's initial value is left out of the address, and what cannot be read counts as left out.
 */

export interface Field<T> {
  readonly initial: T;
  /** The value of all parameters of this name; undefined where they cannot be read. */
  read(values: readonly string[]): T | undefined;
  write(value: T): readonly string[];
}

export type Shape = Readonly<Record<string, Field<unknown>>>;
export type Values<S extends Shape> = {
  readonly [K in keyof S]: S[K] extends Field<infer T> ? T : never;
};

export function text(initial = ""): Field<string> {
  return { initial, read: ([first]) => first, write: (value) => [value] };
}

export function list(): Field<readonly string[]> {
  return { initial: [], read: (values) => values, write: (values) => values };
}

export function choice<const T extends string>(options: readonly T[], initial: T): Field<T> {
  return {
    initial,
    read: ([first]) => options.find((option) => option === first),
    write: (value) => [value],
  };
}

export function flag(initial = false): Field<boolean> {
  return {
    initial,
    read: ([first]) => (first === "1" ? true : first === "0" ? false : undefined),
    write: (value) => [value ? "1" : "0"],
  };
}

/** A number within [least, most]; null where there is none. */
export function number(
  initial: number | null = null,
  least = -Infinity,
  most = Infinity,
): Field<number | null> {
  return {
    initial,
    read: ([first]) => {
      const value = Number(first);
      return first !== "" && value >= least && value <= most ? value : undefined;
    },
    write: (value) => (value === null ? [] : [String(value)]),
  };
}

export function readQuery<S extends Shape>(shape: S, params: URLSearchParams): Values<S> {
  const entries = Object.entries(shape).map(([name, field]) => {
    const given = params.getAll(name);
    const value = given.length > 0 ? field.read(given) : undefined;
    return [name, value === undefined ? field.initial : value];
  });
  return Object.fromEntries(entries) as Values<S>;
}

/** `params` with the fields of a page changed; parameters of others stay. */
export function writeQuery<S extends Shape>(
  shape: S,
  params: URLSearchParams,
  changes: Partial<Values<S>>,
): URLSearchParams {
  const written = new URLSearchParams(params);
  const values = { ...readQuery(shape, params), ...changes };
  for (const [name, field] of Object.entries(shape)) {
    written.delete(name);
    const now = field.write(values[name as keyof S]);
    if (!isSame(now, field.write(field.initial))) {
      for (const value of now) written.append(name, value);
    }
  }
  return written;
}

function isSame(some: readonly string[], others: readonly string[]): boolean {
  return some.length === others.length && some.every((value, place) => value === others[place]);
}
