/** The parts of the documents of evaluations that the page shows (`app/evaluate/.../document.py`). */

export interface Share {
  readonly share: number | null;
  readonly of: number;
  readonly interval_95: readonly [number, number];
}
type Recognized = Readonly<Record<"person" | "task" | "both", Share>>;

interface Unknown {
  readonly refused: Share;
  readonly accepted: Share;
  readonly balanced_accuracy: number | null;
  readonly area_under_curve: number | null;
  readonly equal_error_rate: number | null;
  readonly curve?: readonly { false_acceptance: number; false_rejection: number }[];
}

export interface JudgedRecognizer {
  readonly recognized: Recognized;
  readonly by_group?: Readonly<Record<string, Recognized>>;
  readonly unknown: Readonly<Record<string, Unknown>>;
  readonly confusion?: Readonly<
    Record<string, { labels: readonly string[]; shares: readonly (readonly number[])[] }>
  >;
}

export interface HeldOut {
  readonly chance: Readonly<Record<"person" | "task" | "both", number>>;
  readonly methods: Readonly<Record<string, JudgedRecognizer>>;
}

export interface RecognitionDocument {
  readonly left_out: Readonly<Record<string, HeldOut>>;
  readonly takes_a_cell: Readonly<Record<string, HeldOut>>;
  readonly told: Readonly<
    Record<
      string,
      {
        readonly neither: Recognized;
        readonly person_where_task_is_told: Share;
        readonly task_where_person_is_told: Share;
      }
    >
  >;
  readonly seconds: Readonly<Record<string, { fit: number; probe: number }>>;
  readonly not_judged: Readonly<Record<string, string>>;
}

interface RetrievalFigures {
  readonly method: string;
  readonly nearest: number;
  readonly precision_at_4: number;
  readonly precision_at_20: number;
  readonly mean_average_precision: number;
  readonly queries: number;
}

export interface RetrievalDocument {
  readonly figures: readonly RetrievalFigures[];
  readonly by_group?: Readonly<Record<string, Readonly<Record<string, RetrievalFigures>>>>;
  readonly true_positive_rates: {
    readonly classes: readonly string[];
    readonly k: number;
    readonly mixture: number;
    readonly methods: Readonly<Record<string, Readonly<Record<string, number>>>>;
  };
  readonly confusion?: {
    readonly classes: readonly string[];
    readonly k: number;
    readonly methods: Readonly<Record<string, readonly (readonly number[])[]>>;
  };
  readonly left_out: { readonly unlabeled: number; readonly alone: number };
}

export interface WordRow {
  readonly method: string;
  readonly top_3_recognition: number;
  readonly word_f: number;
  readonly word_map: number;
  readonly set_f: number;
  readonly set_map: number;
  readonly precision: readonly number[];
}

export interface WordsDocument {
  readonly folds: number;
  readonly recalls: readonly number[];
  readonly figures: readonly WordRow[];
  readonly in_sample: readonly WordRow[];
  readonly least_recordings: number;
  readonly by_word: readonly {
    readonly word: string;
    readonly clips: number;
    readonly recordings: number;
    readonly average_precision: number;
    readonly f: number;
    readonly area_under_curve: number;
    readonly too_rare: boolean;
  }[];
  readonly examples: readonly {
    readonly words: readonly string[];
    readonly nearest: readonly {
      readonly id: string;
      readonly name: string;
      readonly ratio: number;
      readonly carries: boolean;
      readonly words: readonly string[];
    }[];
  }[];
}

interface Counts {
  readonly true: number;
  readonly found: number;
  readonly correct: number;
  readonly precision: number;
  readonly recall: number;
  readonly f: number;
}

interface ThresholdCurve {
  readonly values: readonly number[];
  readonly precision: readonly number[];
  readonly recall: readonly number[];
}

export interface KeyposeDocument {
  readonly tolerance: number;
  readonly recordings: number;
  readonly clips?: readonly {
    readonly clip_id: string;
    readonly name: string;
    readonly true: number;
    readonly methods: Readonly<Record<string, { found: number; correct: number }>>;
  }[];
  readonly methods: Readonly<
    Record<
      string,
      {
        readonly held_out: Counts;
        readonly usual_thresholds: Counts;
        readonly by_group?: Readonly<Record<string, Counts>>;
        readonly over_t1: ThresholdCurve;
        readonly over_t2: ThresholdCurve;
      }
    >
  >;
}

export interface LowDimensionalDocument {
  readonly clips: number;
  readonly left_out: number;
  readonly dimensions: readonly {
    readonly dimensions: number;
    readonly clips?: number;
    readonly variance_kept: Readonly<Record<string, number>>;
    readonly error_mm: Readonly<Record<string, number>>;
    readonly keypose_better: number;
  }[];
  readonly poses: readonly {
    readonly basis: string;
    readonly frames: number;
    readonly implausible: number;
    readonly silhouette: number | null;
  }[];
  readonly groups: readonly {
    readonly task: string;
    readonly persons: number;
    readonly poses: number;
    readonly variance_kept: Readonly<Record<string, number>>;
    readonly error_mm: Readonly<Record<string, number>>;
  }[];
}

export interface SymbolsDocument {
  readonly symbols: number;
  readonly errors: readonly {
    readonly dimensions: number;
    readonly classical: number;
    readonly smacof: number;
    readonly s_stress: number;
  }[];
}
