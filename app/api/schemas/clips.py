"""Clips: what clients send with a clip, and what the API shows of it."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, ConfigDict, Field, Json

from app.api.schemas.base import (
    Cursor,
    FormWords,
    Incoming,
    Label,
    Limit,
    Outgoing,
    PartOfName,
    Roles,
    Seconds,
    Words,
)
from app.api.schemas.filters import Filter
from app.api.schemas.jobs import Job
from app.api.schemas.problem import KeptProblem
from app.motion.skeleton.recording import FRAME_RATES
from app.search.index.filters import parse_filter
from app.services.fields import MAX_KEYPOSES, MAX_OFFSET, TEMPI
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipState, Reanalysis

Sort = Literal[
    "created_at",
    "-created_at",
    "name",
    "-name",
    "duration",
    "-duration",
    "person",
    "-person",
    "task",
    "-task",
]
Stack = Annotated[
    str,
    Field(
        max_length=300,
        description="Of an FBX file with several animations, the name of the stack to read;"
        " default: the longest. The clip's warning `stack_chosen` lists them.",
    ),
]
FrameRate = Annotated[
    float, Field(ge=FRAME_RATES[0], le=FRAME_RATES[1], description="Frames a second.")
]

Offset = Annotated[float, Field(ge=-MAX_OFFSET, le=MAX_OFFSET)]
Tempo = Annotated[float, Field(ge=TEMPI[0], le=TEMPI[1])]
_OFFSET = "Seconds of the motion at which the recording begins, negative if before it."


def _split(value: Any) -> Any:
    return value.split() if isinstance(value, str) else value


class ClipWarning(Outgoing):
    """A doubt that does not stop a clip."""

    code: str
    detail: str
    likely: float | None = Field(None, description="The value that is thought right, if any.")


class Clip(Outgoing):
    """A motion-capture clip with its labels."""

    id: str
    name: str
    state: ClipState
    format: str | None
    sha256: str
    person: str | None
    task: str | None
    words: list[str]
    license: str | None
    source: str | None
    frames: int | None
    frame_rate: float | None = Field(description="Frames a second, as used.")
    declared_frame_rate: float | None = Field(description="Frames a second, as the file says.")
    duration: float | None = Field(description="Seconds.")
    joints: int | None = Field(description="Number of joints.")
    roles: dict[str, str] = Field(description="Joint name by joint role.")
    missing_roles: list[str]
    warnings: list[ClipWarning]
    created_at: datetime
    has_audio: bool = Field(description="Whether a recording goes with it: GET .../audio.")
    audio_offset: float | None = Field(
        validation_alias="audio_begins_at",
        description="Seconds of the motion at which the recording begins, as given or estimated."
        " An estimate may be wrong by whole beats: the warning `audio_offset_estimated` says how"
        " long a beat is, and with what probability the estimate is right.",
    )
    error: KeptProblem = Field(description="Why the clip is `failed`, else null.")
    reanalysis: Reanalysis | None = Field(
        description="Where another analysis of a ready clip stands, after a change of the clip or"
        " of Kinedex: null once it is done. Until then the clip is searched by its earlier"
        " analysis. After `failed` it keeps that, and a warning says why."
    )


class ClipCreated(Outgoing):
    """A clip that has been stored, and the job that will make it ready."""

    clip: Clip
    job: Job | None


class ClipList(Outgoing):
    """A page of clips."""

    items: list[Clip]
    next: str | None


class ClipForm(Incoming):
    """The text fields that come with an uploaded clip."""

    name: Label | None = Field(None, description="Default: the file's name.")
    person: Label | None = Field(None, examples=["anna"])
    task: Label | None = Field(None, examples=["walk"])
    words: FormWords | None = Field(
        None, description="Separated by spaces, a phrase with underscores.", examples=["walk slow"]
    )
    license: Label | None = Field(None, examples=["CC-BY-4.0"])
    source: Label | None = None
    frame_rate: FrameRate | None = Field(None, description="Overrides what the file declares.")
    unit: str | None = Field(
        None,
        max_length=30,
        description="m, dm, cm, mm, in, ft, cmu (of CMU's files), or metres per unit.",
    )
    roles: Json[Roles] | None = Field(
        None, description='JSON: joint name by role, as {"hips": "Pelvis"}.'
    )
    stack: Stack | None = None
    audio_offset: Offset | None = Field(None, description=f"{_OFFSET} Default: estimated.")
    tempo: Tempo | None = Field(None, description="Beats a minute, where it is known.")
    beats: Annotated[list[Seconds], BeforeValidator(_split), Field(max_length=MAX_KEYPOSES)] | (
        None
    ) = Field(
        None,
        description="Seconds, separated by spaces; they replace all other beats.",
        examples=["0.5 1.1"],
    )


class ClipPatch(Incoming):
    """Corrections: only fields that are sent change; null forgets one (`name` has none)."""

    name: Label | None = None
    person: Label | None = None
    task: Label | None = None
    words: Words | None = None
    license: Label | None = None
    source: Label | None = None
    frame_rate: FrameRate | None = Field(
        None, description="The clip is analyzed again; null returns to the declared one."
    )
    stack: Label | None = Field(
        None,
        description="Of an FBX file, the animation stack: the clip is analyzed again; null"
        " returns to the longest.",
    )
    audio_offset: Offset | None = Field(
        None, description=f"{_OFFSET} The clip is analyzed again; null has it estimated."
    )
    tempo: Tempo | None = Field(
        None, description="Beats a minute: the clip is analyzed again; null forgets it."
    )
    beats: list[Seconds] | None = Field(
        None,
        max_length=MAX_KEYPOSES,
        description="Seconds; they replace all other beats: the clip is analyzed again; null or"
        " none forgets them.",
    )

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"person": "anna", "words": ["walk", "slow"]}]}
    )


class ClipQuery(Filter):
    """Filters of a list of clips, those of searches among them; all that are given must hold."""

    state: ClipState | None = None
    q: PartOfName | None = Field(None, description="Part of the name.")
    sort: Sort = Field("-created_at", description="A leading - reverses the order.")
    limit: Limit = 10
    cursor: Cursor | None = None

    def as_filter(self) -> ClipFilter:
        """The conditions as the store takes them."""
        states = () if self.state is None else (self.state,)
        return replace(parse_filter(self.given()), state=states, q=self.q)
