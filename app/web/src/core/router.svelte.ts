/**
 * Where the reader is. Own code, since what we need of a router is 100 lines: every state is an
 * address, and the fields of its query are typed (`query`).
 */
import { partsOf } from "./path";
import { root } from "./root";
import { readQuery, writeQuery, type Shape, type Values } from "./query";

export interface Move {
  /** Take the place of the present address instead of following it. */
  replace?: boolean;
}

class Router {
  /** The path without the root; always begins with a slash. */
  path = $state("/");
  /** The parts of the path, decoded: of /clips/abc they are "clips" and "abc". */
  readonly parts = $derived(partsOf(this.path));
  query = $state.raw(new URLSearchParams());

  constructor() {
    this.#read();
  }

  /** Follow the browser's history and the clicks on links to pages; call once. */
  start(): void {
    history.scrollRestoration = "manual";
    addEventListener("popstate", () => {
      this.#read();
      restoreScroll();
    });
    addEventListener("scrollend", keepScroll);
    document.addEventListener("click", (event) => this.#follow(event));
  }

  go(path: string, query = new URLSearchParams(), move: Move = {}): void {
    const address = href(path, query);
    const isNewPage = path !== this.path;
    if (move.replace || address === location.pathname + location.search) {
      history.replaceState(history.state, "", address);
    } else {
      history.pushState(null, "", address);
    }
    this.#read();
    if (isNewPage) scrollTo(0, 0);
  }

  #read(): void {
    this.path = location.pathname.slice(root.length) || "/";
    this.query = new URLSearchParams(location.search);
  }

  #follow(event: MouseEvent): void {
    const isPlain = !(event.ctrlKey || event.metaKey || event.shiftKey || event.altKey);
    const link = (event.target as Element | null)?.closest?.("a");
    if (event.defaultPrevented || event.button !== 0 || !isPlain || !link?.href) return;
    const url = new URL(link.href);
    const isOurs = url.origin === location.origin && url.pathname.startsWith(`${root}/`);
    if (!isOurs || link.target || link.hasAttribute("download") || link.dataset.outside) return;
    if (url.hash && url.pathname === location.pathname) return;
    event.preventDefault();
    this.go(url.pathname.slice(root.length), url.searchParams);
  }
}

export const router = new Router();

/** The address of a page, for links. */
export function href(path: string, query?: URLSearchParams | Record<string, string>): string {
  const text = new URLSearchParams(query).toString();
  return root + path + (text && `?${text}`);
}

/** The typed query of the present page: reactive to read, and `set` moves to another address. */
export class Address<S extends Shape> {
  readonly #shape: S;
  readonly values: Values<S> = $derived.by(() => readQuery(this.#shape, router.query));

  constructor(shape: S) {
    this.#shape = shape;
  }

  set(changes: Partial<Values<S>>, move: Move = {}): void {
    router.go(router.path, writeQuery(this.#shape, router.query, changes), move);
  }
}

function keepScroll(): void {
  history.replaceState({ scroll: scrollY }, "");
}

function restoreScroll(): void {
  const scroll = (history.state as { scroll?: number } | null)?.scroll ?? 0;
  requestAnimationFrame(() => scrollTo(0, scroll));
}
