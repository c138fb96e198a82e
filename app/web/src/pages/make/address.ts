/** What is made, in the address. */
import { text } from "$/core/query";
import { PLAYER } from "$/player/view";

export const MAKE = { ...PLAYER, person: text(), task: text() };
