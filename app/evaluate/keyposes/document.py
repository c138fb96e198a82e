"""An evaluation of keyposes as JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from app.evaluate.keyposes.evaluation import KeyposeEvaluation
from app.models.keyposes.thresholds import ThresholdCurve
from app.services.training.keypose_learning import counts_document


def keypose_document(found: KeyposeEvaluation) -> dict[str, Any]:
    """All results, with the counts of each clip and the curves of figs 4 and 5."""
    return {
        "tolerance": found.tolerance,
        "recordings": found.recordings,
        "clips": [
            {
                "clip_id": clip.clip_id,
                "name": clip.name,
                "task": clip.task,
                "true": clip.true,
                "methods": {
                    method: {"found": counts.found, "correct": counts.correct}
                    for method, counts in clip.counts.items()
                },
            }
            for clip in found.clips
        ],
        "methods": {
            judged.method: {
                "held_out": counts_document(judged.counts),
                "by_group": {
                    group: counts_document(counts)
                    for group, counts in found.by_group(judged.method).items()
                },
                "usual_thresholds": counts_document(judged.usual),
                "learned": asdict(judged.learned),
                "over_t1": _curve(judged.t1),
                "over_t2": _curve(judged.t2),
            }
            for judged in found.methods
        },
    }


def _curve(curve: ThresholdCurve) -> dict[str, list[float]]:
    return {
        "values": curve.values.tolist(),
        "precision": curve.precision.tolist(),
        "recall": curve.recall.tolist(),
    }
