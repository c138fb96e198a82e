"""The output of searches."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from app.cli.output import clip_title, print_csv, print_json, print_table

COLUMNS = (
    "rank",
    "score",
    "distance",
    "start",
    "end",
    "time",
    "clip.id",
    "clip.name",
    "clip.path",
    "clip.person",
    "clip.task",
    "clip.words",
    "clip.duration",
)
"""The columns of hits as CSV. A search by pose has `time` instead of `start` and `end`."""


def print_hits(hits: Any, times: Sequence[str], *, as_json: bool, as_csv: bool) -> None:
    """Print a page of hits.

    hits: a page of the client (MotionHits, WordHits or PoseHits). times: the fields that say which
    part of each clip was found.
    """
    if as_json:
        print_json(hits.to_json())
    elif as_csv:
        others = {"start", "end", "time"} - set(times)
        print_csv([name for name in COLUMNS if name not in others], hits.to_json()["items"])
    else:
        # Parts of clips have their times instead: with both, a line of 80 characters is too short.
        numbers = times or ("distance",)
        columns = ("rank", "score", *numbers, "name", "person", "task", "id")
        rows = [
            (
                hit.rank,
                hit.score,
                *(getattr(hit, name) for name in numbers),
                clip_title(hit.clip.name, hit.clip.path),
                hit.clip.person,
                hit.clip.task,
                hit.clip.id,
            )
            for hit in hits
        ]
        print_table(columns, rows, cut=("name", "person", "task"))
