"""An evaluation of low-dimensional motion as JSON."""

from __future__ import annotations

from typing import Any

from app.evaluate.low_dimensional.evaluation import LowDimensionalEvaluation


def low_dimensional_document(found: LowDimensionalEvaluation) -> dict[str, Any]:
    """All results: figures by dimensions, by basis, and for groups of persons."""
    return {
        "clips": found.clips,
        "left_out": found.left_out,
        "dimensions": [
            {
                "dimensions": row.dimensions,
                "clips": row.clips,
                "variance_kept": dict(row.variance),
                "error_mm": {**row.error, "all_frames": row.best},
                "keypose_better": row.keypose_better,
            }
            for row in found.dimensions
        ],
        "poses": [
            {
                "basis": row.name,
                "frames": row.frames,
                "implausible": row.implausible,
                "faults": dict(row.faults),
                "silhouette": row.silhouette,
            }
            for row in found.poses
        ],
        "more_clustered": found.more_clustered,
        "groups": [
            {
                "task": row.task,
                "persons": row.persons,
                "poses": row.poses,
                "variance_kept": dict(row.variance),
                "error_mm": dict(row.error),
                "silhouette": dict(row.silhouette),
                "gap": dict(row.gap),
            }
            for row in found.groups
        ],
    }
