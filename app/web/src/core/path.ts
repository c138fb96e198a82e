/** The parts of a path between its slashes, decoded: of /people/Ana%20B they are people, Ana B. */
export function partsOf(path: string): readonly string[] {
  return path.split("/").filter(Boolean).map(decoded);
}

function decoded(part: string): string {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}
