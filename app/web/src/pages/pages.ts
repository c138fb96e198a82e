/** The pages in the order of the navigation. A page's code is loaded when it is opened. */
import type { Component } from "svelte";
import type { IconName } from "$/ui/icons";

export interface PageEntry {
  /** The first part of the address; `app/api/guard/page_paths.py` names the same. */
  readonly name: string;
  readonly label: string;
  readonly icon: IconName;
  readonly load: () => Promise<{ default: Component }>;
}

export const PAGES: readonly PageEntry[] = [
  {
    name: "",
    label: "Gallery",
    icon: "gallery",
    load: () => import("./gallery/Gallery.svelte"),
  },
  {
    name: "search",
    label: "Search",
    icon: "search",
    load: () => import("./search/Search.svelte"),
  },
  {
    name: "map",
    label: "Map",
    icon: "map",
    load: () => import("./map/MapPage.svelte"),
  },
  {
    name: "todo",
    label: "To do",
    icon: "todo",
    load: () => import("./todo/Todo.svelte"),
  },
  {
    name: "collections",
    label: "Collections",
    icon: "collection",
    load: () => import("./collections/Collections.svelte"),
  },
  {
    name: "models",
    label: "People",
    icon: "people",
    load: () => import("./models/Models.svelte"),
  },
  {
    name: "make",
    label: "Make",
    icon: "make",
    load: () => import("./make/Make.svelte"),
  },
  {
    name: "live",
    label: "Live",
    icon: "live",
    load: () => import("./live/Live.svelte"),
  },
];

/** Pages that the navigation does not list. */
export const OTHER_PAGES: readonly Pick<PageEntry, "name" | "load">[] = [
  { name: "clips", load: () => import("./clip/ClipPage.svelte") },
  { name: "compare", load: () => import("./compare/ComparePage.svelte") },
  { name: "study", load: () => import("./study/Study.svelte") },
];

/** The page of the first part of a path; undefined where there is none. */
export function pageOf(name: string | undefined): Pick<PageEntry, "name" | "load"> | undefined {
  return [...PAGES, ...OTHER_PAGES].find((page) => page.name === (name ?? ""));
}
