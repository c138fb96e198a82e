/** Failures of calls, in words. */
import type { components } from "./schema";

export type ProblemDetails = components["schemas"]["Problem"];

/** The service answered with a problem (RFC 9457). */
export class ApiProblem extends Error {
  constructor(readonly details: ProblemDetails) {
    super(details.detail);
  }

  get code(): string {
    return this.details.code;
  }
}

/** The service did not answer. */
export class Away extends Error {
  constructor() {
    super("Kinedex does not answer.");
  }
}

/** What went wrong, as sentences for a reader: the detail, then each place that is wrong. */
export function inWords(failure: unknown): string[] {
  if (!(failure instanceof ApiProblem)) {
    return [failure instanceof Error ? failure.message : String(failure)];
  }
  const { detail, errors } = failure.details;
  return [detail, ...errors.map(({ location, message }) => `${place(location)}: ${message}`)];
}

/** `body.filter.person` is the field "filter, person". */
function place(location: string): string {
  const parts = location.replace(/^(body|query|path|header)\./, "").split(".");
  return parts.join(", ").replaceAll("_", " ");
}

/** The problem in an answer, or one made of its status where it holds none. */
export function problemOf(body: unknown, status: number): ApiProblem {
  if (isProblem(body)) return new ApiProblem(body);
  const detail = `Kinedex answered with the status ${status}.`;
  const title = "Unexpected answer";
  return new ApiProblem({
    type: "about:blank",
    title,
    status,
    detail,
    code: "unknown",
    errors: [],
  });
}

function isProblem(body: unknown): body is ProblemDetails {
  return typeof body === "object" && body !== null && "code" in body && "detail" in body;
}
