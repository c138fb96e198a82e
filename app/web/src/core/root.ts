/** The path under which a proxy puts the service: "" or "/prefix". */
export const root = rootOf(import.meta.url);

/** Built files are at `<root>/assets/<name>`; anywhere else (development, tests) the root is "". */
export function rootOf(file: string): string {
  const { pathname } = new URL(file);
  const at = pathname.lastIndexOf("/assets/");
  return at < 0 ? "" : pathname.slice(0, at);
}
