/** Short messages at the bottom of the page, with at most one thing to do about each. */

export interface Notice {
  readonly id: number;
  readonly text: string;
  readonly action?: { readonly label: string; readonly run: () => void };
  /** Called when the notice ends without its action. */
  readonly expire?: () => void;
}

const NOTICE_MS = 8000;
/** Who reads slowly, or by ear, needs time to take something back. */
const OFFER_MS = 20_000;

class Notices {
  items: readonly Notice[] = $state.raw([]);
  #next = 0;
  readonly #timers = new Map<number, number>();

  show(text: string, more: Omit<Notice, "id" | "text"> = {}): void {
    const notice = { id: this.#next++, text, ...more };
    this.items = [...this.items, notice];
    this.#timers.set(
      notice.id,
      window.setTimeout(() => this.dismiss(notice), notice.action ? OFFER_MS : NOTICE_MS),
    );
  }

  /** Do what the notice offers, and end it. */
  act(notice: Notice): void {
    if (this.#end(notice)) notice.action?.run();
  }

  dismiss(notice: Notice): void {
    if (this.#end(notice)) notice.expire?.();
  }

  /** End all of them, since the page is being left. */
  dismissAll(): void {
    for (const notice of this.items) this.dismiss(notice);
  }

  #end(notice: Notice): boolean {
    clearTimeout(this.#timers.get(notice.id));
    this.#timers.delete(notice.id);
    const isShown = this.items.includes(notice);
    this.items = this.items.filter((other) => other !== notice);
    return isShown;
  }
}

export const notices = new Notices();
