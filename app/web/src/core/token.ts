/** A color of tokens.css where `element` stands: `light-dark(...)` as the one that counts there. */
export function tokenColor(element: Element, name: string): string {
  const probe = document.createElement("i");
  probe.style.color = getComputedStyle(element).getPropertyValue(name);
  element.append(probe);
  const color = getComputedStyle(probe).color;
  probe.remove();
  return color;
}
