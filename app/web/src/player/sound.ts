/** The recording of a clip, played in step with it. */
import { askFor } from "$/api/client";

/** Seconds by which sound and motion may be apart before the sound is moved. */
const MAX_APART = 0.08;

export class Sound {
  readonly #context = new AudioContext();
  /** Seconds of the motion at which the recording begins. */
  readonly #begins: number;
  #buffer: AudioBuffer | null = null;
  #source: AudioBufferSourceNode | null = null;
  /** Motion time and context time when the source was started, and its speed. */
  #started = { motion: 0, context: 0, speed: 1 };

  private constructor(begins: number) {
    this.#begins = begins;
  }

  /** The recording of a clip, decoded. Throws ApiProblem, Away, DOMException. */
  static async of(clipId: string, begins: number): Promise<Sound> {
    const sound = new Sound(begins);
    const answer = await askFor(`/v1/clips/${encodeURIComponent(clipId)}/audio`);
    sound.#buffer = await sound.#context.decodeAudioData(await answer.arrayBuffer());
    return sound;
  }

  /** Play as the motion does now; to be called for each frame that is shown. */
  follow(seconds: number, speed: number): void {
    const { motion, context, speed: before } = this.#started;
    const heard = motion + (this.#context.currentTime - context) * before;
    if (this.#source && speed === before && Math.abs(heard - seconds) < MAX_APART) return;
    this.stop();
    void this.#context.resume();
    const into = seconds - this.#begins;
    const wait = Math.max(0, -into) / speed;
    this.#source = new AudioBufferSourceNode(this.#context, {
      buffer: this.#buffer,
      playbackRate: speed,
    });
    this.#source.connect(this.#context.destination);
    this.#source.start(this.#context.currentTime + wait, Math.max(0, into));
    this.#started = { motion: seconds, context: this.#context.currentTime, speed };
  }

  stop(): void {
    this.#source?.stop();
    this.#source = null;
  }

  dispose(): void {
    this.stop();
    void this.#context.close();
  }
}
