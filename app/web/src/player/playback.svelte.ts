/** The time of a player: it runs, stops, is sought, and repeats a range. */
import { untrack } from "svelte";
import { SPEEDS, within, type PlayerValues } from "./view";

/** What the playback must know of its player; all are read when they are needed. */
export interface Played {
  readonly values: PlayerValues;
  /** Seconds: the length of the longest clip, and of a frame of the first. */
  readonly seconds: number;
  readonly frameSeconds: number;
  readonly onview: (changes: Partial<PlayerValues>) => void;
  /** Called for each step in time while it plays, and when it stops. */
  readonly onstep: (seconds: number, speed: number) => void;
  readonly onstop: () => void;
}

const REST_MS = 150;
/** The place of the usual speed in SPEEDS. */
const USUAL = 3;

export class Playback {
  time = $state(0);
  isPlaying = $state(false);
  readonly #of: Played;
  /** The time that the address was told last. */
  #told: number | null;
  #resting = 0;

  /** Has effects: make it while a component begins. */
  constructor(of: Played) {
    this.#of = of;
    this.#told = untrack(() => of.values.t);
    this.time = this.#told ?? 0;
    // Back, forward and links move the time; what the player told itself does not.
    $effect(() => {
      const t = of.values.t;
      untrack(() => {
        if (t !== this.#told) this.time = t ?? 0;
        this.#told = t;
      });
    });
    $effect(() => (this.isPlaying ? this.#run() : undefined));
  }

  /** The range that is played, seconds. */
  get range(): readonly [number, number] {
    const { values, seconds } = this.#of;
    return [values.from ?? 0, Math.min(values.to ?? seconds, seconds)];
  }

  toggle(): void {
    if (this.isPlaying) this.stop();
    else this.play();
  }

  play(): void {
    const [from, to] = this.range;
    if (this.time >= to - this.#of.frameSeconds / 2) this.time = from;
    this.isPlaying = true;
  }

  stop(): void {
    this.isPlaying = false;
    this.#tell();
  }

  /** Browsers allow an address to change some 20 times a second: it is told when a scrub rests. */
  seek(to: number): void {
    this.time = Math.min(Math.max(0, to), this.#of.seconds);
    clearTimeout(this.#resting);
    if (!this.isPlaying) this.#resting = window.setTimeout(() => this.#tell(), REST_MS);
  }

  /** Stop, and go some frames forth, or back. */
  step(frames: number): void {
    this.isPlaying = false;
    this.seek(this.time + frames * this.#of.frameSeconds);
  }

  repeat(from: number | null, to: number | null): void {
    const rounded = (value: number | null): number | null =>
      value === null ? null : Number(value.toFixed(3));
    this.#of.onview({ from: rounded(from), to: rounded(to) });
  }

  /** The range begins now; an end before it is forgotten. */
  begin(): void {
    const { to } = this.#of.values;
    this.repeat(this.time, to !== null && to > this.time ? to : null);
  }

  end(): void {
    const { from } = this.#of.values;
    this.repeat(from !== null && from < this.time ? from : null, this.time);
  }

  /** The next higher speeds, or lower ones. */
  hasten(by: number): void {
    const at = SPEEDS.findIndex((speed) => speed === this.#of.values.speed);
    const next = Math.min(Math.max(0, (at < 0 ? USUAL : at) + by), SPEEDS.length - 1);
    this.#of.onview({ speed: SPEEDS[next] ?? 1 });
  }

  #tell(): void {
    this.#told = Number(this.time.toFixed(3));
    this.#of.onview({ t: this.#told });
  }

  #run(): () => void {
    let request = 0;
    let before = performance.now();
    const step = (now: number): void => {
      const { values } = this.#of;
      const passed = ((now - before) / 1000) * (values.speed ?? 1);
      const { time, isOver } = within(this.time + passed, this.range, values.loop);
      before = now;
      this.time = time;
      this.#of.onstep(time, values.speed ?? 1);
      if (isOver) this.stop();
      else request = requestAnimationFrame(step);
    };
    request = requestAnimationFrame(step);
    return () => {
      cancelAnimationFrame(request);
      this.#of.onstop();
    };
  }
}
