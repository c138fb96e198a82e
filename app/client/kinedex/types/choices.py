"""Texts that values may be. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from typing import Literal, TypeAlias

AnnotationFormat: TypeAlias = Literal["csv", "eaf", "babel"]


Basis: TypeAlias = Literal["keypose", "uniform"]


BodyPart: TypeAlias = Literal["arms", "legs", "upper_body"]


Choice: TypeAlias = Literal["left", "right", "same"]


ClipState: TypeAlias = Literal["queued", "processing", "ready", "failed"]


EditKind: TypeAlias = Literal["cut", "mirror", "resample", "in_place", "loop"]


EvaluationKind: TypeAlias = Literal[
    "recognition", "retrieval", "words", "keyposes", "low-dimensional", "symbols"
]


ExportContent: TypeAlias = Literal["positions", "angles", "segments", "gait", "strides", "cycles"]


ExportFormat: TypeAlias = Literal["bvh", "glb", "npz", "csv", "c3d", "trc"]


ExportJoints: TypeAlias = Literal["all", "roles"]


ExportSkeleton: TypeAlias = Literal["own", "canonical"]


ExportUnit: TypeAlias = Literal["m", "cm", "mm", "in", "ft"]


Fault: TypeAlias = Literal["folded", "bent_backward", "turned_away", "in_trunk"]


FileOutcome: TypeAlias = Literal[
    "queued",
    "processing",
    "ready",
    "updated",
    "unchanged",
    "conflicting",
    "failed",
    "skipped",
    "deleted",
    "absent",
]


GroupBy: TypeAlias = Literal["person", "task", "source", "duplicates"]


JobKind: TypeAlias = Literal["ingest", "import", "fit", "evaluate"]


JobState: TypeAlias = Literal["queued", "processing", "succeeded", "failed", "canceled"]


JointRole: TypeAlias = Literal[
    "left_knee",
    "right_knee",
    "left_foot",
    "right_foot",
    "hips",
    "left_elbow",
    "right_elbow",
    "left_shoulder",
    "right_shoulder",
    "neck",
    "head",
    "left_hand",
    "right_hand",
    "left_toes",
    "right_toes",
    "chest",
    "left_upper_leg",
    "right_upper_leg",
]


KeyRole: TypeAlias = Literal["read", "write", "admin"]


LinkKind: TypeAlias = Literal["people", "phrase", "inflection", "lexicon"]


MatchesPerClip: TypeAlias = Literal["best", "all"]


Method: TypeAlias = Literal[
    "fused", "vector", "dtw", "msv-dtw", "msv-xcorr", "metric-task", "metric-person"
]


OutlierReason: TypeAlias = Literal["far", "swapped"]


PairKind: TypeAlias = Literal["exact", "copy", "rate", "format", "cut", "mirror", "similar"]


Reanalysis: TypeAlias = Literal["queued", "processing", "failed"]


Side: TypeAlias = Literal["left", "original", "right"]


SynthesisKind: TypeAlias = Literal["new_task", "new_person", "seen"]


ValueKind: TypeAlias = Literal["string", "number", "boolean"]
