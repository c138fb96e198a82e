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
  it("let the newest group go first, in its order, and leave out what is not wanted", async () => {
    const turns = new Turns(1);
    const order: string[] = [];
    let finish = (): void => undefined;
    const signal = new AbortController().signal;
    const first = turns.take(() => new Promise<void>((done) => (finish = done)), signal);
    const left = new AbortController();
    const take = (name: string): Promise<void> =>
      turns
        .take(async () => void order.push(name), name === "b" ? left.signal : signal)
        .catch(() => undefined);
    const older = ["a", "b", "c"].map(take);
    await Promise.resolve();
    const newer = ["d", "e"].map(take);
    left.abort();
    finish();
    await Promise.all([first, ...older, ...newer]);
    expect(order).toEqual(["d", "e", "a", "c"]);
  });
});
