"""Edits of clips that make new clips."""

from __future__ import annotations

from pydantic import ConfigDict, Field

from app.api.schemas.base import Incoming, Label, Seconds
from app.services.editing.steps import MAX_LOOP_SECONDS, MAX_STEPS, EditKind, EditStep
from app.services.views.frame_rates import MAX_FPS, MIN_FPS


class Step(Incoming):
    """One step of an edit."""

    kind: EditKind = Field(
        description="cut: keep the part from `start` to `end`. mirror: exchange left and right,"
        " also in the labels. resample: another frame rate, `fps`. in_place: remove the horizontal"
        " path of the hips. loop: keep the best loop, with its end blended into its beginning."
    )
    start: Seconds | None = Field(
        None, description="Of a cut: seconds of the motion before this step; default: its start."
    )
    end: Seconds | None = Field(None, description="Of a cut: seconds; default: the end.")
    fps: float | None = Field(
        None, ge=MIN_FPS, le=MAX_FPS, description="Of resample: frames per second."
    )
    min_seconds: float | None = Field(
        None, ge=0, le=MAX_LOOP_SECONDS, description="Of a loop: the shortest; default: 0.5 s."
    )
    max_seconds: float | None = Field(
        None, ge=0, le=MAX_LOOP_SECONDS, description="Of a loop: the longest; default: any."
    )

    def step(self) -> EditStep:
        """The step of the service."""
        return EditStep(**self.model_dump(exclude_unset=True))


class ClipEdit(Incoming):
    """Steps that make a new clip from a clip."""

    steps: list[Step] = Field(min_length=1, max_length=MAX_STEPS)
    name: Label | None = Field(
        None, description="Of the new clip. Default: the original's name and the steps."
    )

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"steps": [{"kind": "cut", "start": 0, "end": 1.5}, {"kind": "mirror"}]},
            ]
        }
    )
