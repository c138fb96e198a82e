/** The keys of a queue. */

/** The key of an event that is for the queue; null where somebody types, or a control takes it. */
export function keyOf(event: KeyboardEvent): string | null {
  const target = event.target as HTMLElement;
  const isTyping = target.matches(
    "input:not([type=checkbox], [type=radio]), select, textarea, dialog *",
  );
  const isOwn = event.key === "Enter" && target.closest("a, button, input, summary") !== null;
  if (event.ctrlKey || event.metaKey || event.altKey || isTyping || isOwn) return null;
  return event.key.length === 1 ? event.key.toLowerCase() : event.key;
}
