/** Whether the service answers, and who is signed in. */
import { root } from "$/core/root";
import type { components } from "./schema";

export type Session = components["schemas"]["Session"];

const FIRST_WAIT_MS = 1000;
const MAX_WAIT_MS = 15_000;

class Server {
  isAway = $state(false);
  /** When the next attempt begins (ms since 1970), while the service is away. */
  nextTryAt = $state(0);
  session: Session | null = $state.raw(null);
  /** Grows when the service is back or somebody signed in: what failed is asked for again. */
  epoch = $state(0);
  readonly needsSignIn = $derived(
    this.session !== null && this.session.keys_needed && this.session.role === null,
  );
  readonly mayWrite = $derived(
    this.session === null || !this.session.keys_needed || this.session.role !== "read",
  );
  #timer = 0;
  #wait = FIRST_WAIT_MS;

  /** A call got no answer: look for the service until it is back. */
  lost(): void {
    if (this.isAway) return;
    this.isAway = true;
    this.#wait = FIRST_WAIT_MS;
    this.#later();
  }

  /** A call was answered. */
  found(): void {
    if (!this.isAway) return;
    this.isAway = false;
    clearTimeout(this.#timer);
    this.epoch += 1;
  }

  /** Ask now whether the service answers. */
  async tryNow(): Promise<void> {
    clearTimeout(this.#timer);
    try {
      const answer = await fetch(`${root}/livez`, { cache: "no-store" });
      if (!answer.ok) throw new Error(answer.statusText);
      this.found();
    } catch {
      this.#wait = Math.min(this.#wait * 1.5, MAX_WAIT_MS);
      this.#later();
    }
  }

  signedIn(session: Session): void {
    this.session = session;
    this.epoch += 1;
  }

  /** A key is asked for: it was never given, or it counts no more. */
  refused(): void {
    this.session = { keys_needed: true, role: null, source: null, expires_at: null };
  }

  #later(): void {
    this.nextTryAt = Date.now() + this.#wait;
    this.#timer = window.setTimeout(() => void this.tryNow(), this.#wait);
  }
}

export const server = new Server();
