/**
 * Files on their way into the library. However many are handed in, they go as one ZIP to one
 * import: its one job is followed by one connection, skeletons find their motions, and a manifest
 * is read.
 */
import { api, ask, type Schemas } from "$/api/client";
import { followed, type Job } from "$/api/jobs";
import { problemOf } from "$/api/problem";
import { server } from "$/api/server.svelte";
import { root } from "$/core/root";
import type { Found } from "./collect";

export type JobFile = Schemas["JobFile"];

const MAX_LISTED = 1000;

export class Upload {
  readonly name: string;
  phase: "packing" | "sending" | "analyzing" | "done" | "failed" = $state("packing");
  /** Share of the phase that is done, 0 to 1. */
  progress = $state(0);
  job: Job | null = $state.raw(null);
  files: readonly JobFile[] = $state.raw([]);
  failure: unknown = $state.raw();
  readonly isOver = $derived(this.phase === "done" || this.phase === "failed");
  #isListing = false;
  readonly #onchange: () => void;

  /** start: begins the import. onchange: called when clips have come or changed. */
  private constructor(name: string, start: (upload: Upload) => Promise<Job>, onchange: () => void) {
    this.name = name;
    this.#onchange = onchange;
    void this.#run(start);
  }

  /** Files that somebody has chosen or dropped. */
  static of(found: readonly Found[], onchange: () => void): Upload {
    const only = found.length === 1 ? found[0]?.file.name : undefined;
    return new Upload(only ?? `${found.length} files`, (upload) => upload.#send(found), onchange);
  }

  /** The demo library, which the service makes itself. */
  static demo(onchange: () => void): Upload {
    const start = async (): Promise<Job> => (await ask(api.POST("/v1/imports/demo"))).job;
    return new Upload("Demo library", start, onchange);
  }

  async #send(found: readonly Found[]): Promise<Job> {
    const archive = await packed(found);
    this.phase = "sending";
    return sent(archive, (share) => (this.progress = share));
  }

  async #run(start: (upload: Upload) => Promise<Job>): Promise<void> {
    try {
      this.job = await start(this);
      this.phase = "analyzing";
      this.progress = 0;
      this.job = await followed(this.job.id, (job) => this.#show(job));
      await this.#read(this.job.id);
      this.failure = this.job.error ? problemOf(this.job.error, 0) : undefined;
      this.phase = this.job.state === "succeeded" ? "done" : "failed";
    } catch (failure) {
      this.failure = failure;
      this.phase = "failed";
    }
    this.#onchange();
  }

  #show(job: Job): void {
    this.job = job;
    this.progress = job.progress;
    void this.#list(job.id);
    this.#onchange();
  }

  async #list(id: string): Promise<void> {
    if (this.#isListing) return;
    this.#isListing = true;
    try {
      await this.#read(id);
    } finally {
      this.#isListing = false;
    }
  }

  async #read(id: string): Promise<void> {
    const params = { path: { job_id: id }, query: { limit: MAX_LISTED } };
    const files = (await ask(api.GET("/v1/jobs/{job_id}/files", { params }))).items;
    // An earlier call may be answered after the last one.
    if (!this.isOver) this.files = files;
  }
}

async function packed(found: readonly Found[]): Promise<Blob> {
  const only = found.length === 1 ? found[0] : undefined;
  if (only && /\.zip$/i.test(only.path)) return only.file;
  const { downloadZip } = await import("client-zip");
  return downloadZip(found.map(({ path, file }) => ({ name: path, input: file }))).blob();
}

/** XMLHttpRequest, since fetch does not say how much it has sent. */
function sent(archive: Blob, onprogress: (share: number) => void): Promise<Job> {
  return new Promise((take, fail) => {
    const request = new XMLHttpRequest();
    request.responseType = "json";
    request.upload.onprogress = ({ loaded, total }) => onprogress(loaded / total);
    request.onload = () => {
      const answer = request.response as { job: Job } | null;
      if (request.status < 300 && answer) take(answer.job);
      else fail(problemOf(answer, request.status));
    };
    request.onerror = () => {
      server.lost();
      fail(new Error("The connection broke while the files were sent. Send them again."));
    };
    const form = new FormData();
    form.append("archive", archive, "upload.zip");
    request.open("POST", `${root}/v1/imports`);
    request.send(form);
  });
}
