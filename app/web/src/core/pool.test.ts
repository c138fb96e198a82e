import { describe, expect, it } from "vitest";
import { forEachOf, Turns } from "./pool";

describe("work on many items", () => {
  it("keeps to its limit, does all, and names failures", async () => {
    let running = 0;
    let most = 0;
    const done: number[] = [];
    const failures = await forEachOf([1, 2, 3, 4, 5, 6, 7], 3, async (item) => {
      most = Math.max(most, (running += 1));
      await Promise.resolve();
      running -= 1;
      if (item === 4) throw new Error("four");
      done.push(item);
    });
    expect(most).toBe(3);
    expect(done.sort()).toEqual([1, 2, 3, 5, 6, 7]);
    expect(failures.map(({ item }) => item)).toEqual([4]);
  });
});

describe("turns", () => {
  it("let the newest go first, and leave out what is not wanted any more", async () => {
    const turns = new Turns(1);
    const order: string[] = [];
    let finish = (): void => undefined;
    const signal = new AbortController().signal;
    const first = turns.take(() => new Promise<void>((done) => (finish = done)), signal);
    const left = new AbortController();
    const rest = ["a", "b", "c"].map((name) =>
      turns
        .take(async () => void order.push(name), name === "b" ? left.signal : signal)
        .catch(() => undefined),
    );
    left.abort();
    finish();
    await Promise.all([first, ...rest]);
    expect(order).toEqual(["c", "a"]);
  });
});
