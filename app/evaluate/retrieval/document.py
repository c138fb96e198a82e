"""An evaluation of retrieval as JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from app.evaluate.retrieval.evaluation import RetrievalEvaluation
from app.evaluate.retrieval.volumes import VolumeEvaluation


def retrieval_document(found: RetrievalEvaluation, volumes: VolumeEvaluation) -> dict[str, Any]:
    """All results; volumes: the motion volumes of the same clips."""
    return {
        "figures": [asdict(judged.figures) for judged in found.methods],
        "by_group": {
            judged.figures.method: {
                group: asdict(figures) for group, figures in judged.by_group.items()
            }
            for judged in found.methods
        },
        "true_positive_rates": {
            "classes": found.chosen,
            "k": found.k,
            "mixture": found.mixture,
            "methods": {
                judged.figures.method: {
                    **dict(zip(found.chosen, judged.rates.tolist(), strict=True)),
                    "overall": judged.overall,
                }
                for judged in found.methods
            },
        },
        "confusion": {
            "classes": found.classes,
            "k": found.k,
            "sizes": found.sizes,
            "methods": {one.figures.method: one.confusion.tolist() for one in found.methods},
            "overall": {one.figures.method: one.overall_confusion for one in found.methods},
        },
        "left_out": {"unlabeled": found.unlabeled, "alone": found.alone},
        "volumes": {
            "q": volumes.q,
            "eta": volumes.threshold,
            "clips": len(volumes.iterations),
            "converged": volumes.converged,
            "median_iterations": float(np.median(volumes.iterations)),
            "most_iterations": max(volumes.iterations),
            "compression": asdict(volumes.compression),
        },
    }
