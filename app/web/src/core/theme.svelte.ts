/** Light or dark: the system's choice, or the reader's. */

export const CHOICES = ["system", "light", "dark"] as const;
export type Choice = (typeof CHOICES)[number];
const KEY = "kinedex-theme";

class Theme {
  choice: Choice = $state(kept());
  #systemIsDark = $state(false);
  readonly isDark = $derived(
    this.choice === "system" ? this.#systemIsDark : this.choice === "dark",
  );

  /** Follow the system, and put what was chosen in place; call once. */
  start(): void {
    const query = matchMedia("(prefers-color-scheme: dark)");
    this.#systemIsDark = query.matches;
    query.addEventListener("change", () => (this.#systemIsDark = query.matches));
    this.#show();
  }

  choose(choice: Choice): void {
    this.choice = choice;
    localStorage.setItem(KEY, choice);
    this.#show();
  }

  #show(): void {
    document.documentElement.dataset.theme = this.choice;
  }
}

function kept(): Choice {
  const found = localStorage.getItem(KEY);
  return CHOICES.find((choice) => choice === found) ?? "system";
}

export const theme = new Theme();
