/** The files that were searched with, by name, until the pages are loaded anew. */
import { SvelteMap } from "svelte/reactivity";

export const files = new SvelteMap<string, File>();
