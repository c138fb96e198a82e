/** Follows jobs to their end. */
import { root } from "$/core/root";
import type { Schemas } from "./client";
import { server } from "./server.svelte";

export type Job = Schemas["Job"];

/** The job when it has ended. onprogress: called with the job whenever it got further. */
export function followed(
  id: string,
  onprogress: (job: Job) => void,
  signal?: AbortSignal,
): Promise<Job> {
  const events = new EventSource(`${root}/v1/jobs/${id}/events`);
  signal?.addEventListener("abort", () => events.close());
  return new Promise((ended) => {
    events.addEventListener("progress", (event) => {
      onprogress(JSON.parse(event.data as string) as Job);
    });
    events.addEventListener("done", (event) => {
      events.close();
      ended(JSON.parse(event.data as string) as Job);
    });
    // The browser opens the stream again by itself; meanwhile we look for the service.
    events.addEventListener("error", () => server.lost());
    events.addEventListener("open", () => server.found());
  });
}
