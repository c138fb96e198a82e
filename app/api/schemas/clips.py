"""Clips: the fields that clients send with a clip, and those that the API shows."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, Json

from app.api.schemas.base import (
    ENERGY,
    NAMED,
    SPEED,
    TEMPO,
    TRAVEL,
    Captions,
    Cursor,
    Fields,
    FormCaptions,
    FormWords,
    Incoming,
    Label,
    Limit,
    Metadata,
    MetadataChanges,
    Outgoing,
    Paged,
    PartOfName,
    Path,
    Roles,
    Seconds,
    Words,
    not_null,
)
from app.api.schemas.clip_remarks import ClipWarning, Difference
from app.api.schemas.filters import Filter
from app.api.schemas.jobs import Job
from app.api.schemas.problem import StoredProblem
from app.motion.canonical.units import METERS_PER_UNIT
from app.motion.skeleton.recording import FRAME_RATES
from app.search.index.filters import parse_filter
from app.services.fields import MAX_KEYPOSES, MAX_OFFSET, TEMPI
from app.store.clips.filter import MISSABLE, ClipFilter
from app.store.clips.listing import SORT_NAMES
from app.store.clips.record import ClipState, Reanalysis


def _is_order(name: str) -> str:
    if name.removeprefix("-") not in SORT_NAMES:
        raise ValueError(f"Input should be one of {', '.join(SORT_NAMES)}, or one with a leading -")
    return name


Sort = Annotated[
    str,
    AfterValidator(_is_order),
    Field(max_length=40, json_schema_extra={"pattern": f"^-?({'|'.join(SORT_NAMES)})$"}),
]
Stack = Annotated[
    str,
    Field(
        max_length=300,
        description="The name of the animation stack to read, if an FBX file has several; default:"
        " the longest. The clip's warning `stack_chosen` lists them.",
    ),
]
FrameRate = Annotated[
    float, Field(ge=FRAME_RATES[0], le=FRAME_RATES[1], description="Frames per second.")
]
FileFrameRate = Annotated[
    FrameRate | None, Field(description="It replaces the frame rate that the file declares.")
]
_UNIT = rf"^({'|'.join(METERS_PER_UNIT)}|0?\.0{{0,5}}[1-9][0-9]*|[1-9][0-9]{{0,2}}(\.[0-9]+)?)$"
"""A name or a number. Numbers with an exponent are read too."""
Unit = Annotated[
    str | None,
    Field(
        max_length=30,
        json_schema_extra={"pattern": _UNIT},
        description="m, dm, cm, mm, in, ft, cmu (unit of the CMU files), or meters per unit.",
    ),
]
UpAxis = Annotated[
    Literal["x", "y", "z", "-x", "-y", "-z"],
    Field(
        description="The axis of the file that points up. Without it, the axis that the file says"
        " is used, else the one along which the body stands: then the clip has the warning"
        " `up_axis_guessed`."
    ),
]
FormRoles = Annotated[
    Json[Roles] | None,
    Field(
        description='JSON: joint name by role, as in {"hips": "Pelvis"}; a list of two names is for'
        ' their middle, as in {"hips": ["LHip", "RHip"]}. A body that seems to be an animal is'
        " refused as `skeleton_not_human`, with the reasons, unless roles are sent."
    ),
]

Offset = Annotated[float, Field(ge=-MAX_OFFSET, le=MAX_OFFSET)]
Tempo = Annotated[float, Field(ge=TEMPI[0], le=TEMPI[1])]
_OFFSET = "Time in the motion at which the recording begins, seconds; may be negative."


def _split(value: Any) -> Any:
    return value.split() if isinstance(value, str) else value


FormBeats = Annotated[
    list[Seconds],
    BeforeValidator(_split, json_schema_input_type=str),
    Field(max_length=MAX_KEYPOSES),
]


class ClipOrigin(Outgoing):
    """Where an edited copy comes from."""

    clip_id: str = Field(description="The id of the original.")
    deleted: bool = Field(
        validation_alias="is_deleted", description="Whether the original was deleted since."
    )
    steps: list[dict[str, Any]] = Field(
        description="The edits in their order, each with its `kind`. Those that keep a part have"
        " its `start` and `end`, seconds of the motion before the step."
    )


class Clip(Outgoing):
    """A motion-capture clip with its labels."""

    id: str
    name: str
    path: str | None = Field(
        description="Path of the file, relative to its import; null for a file without a path."
    )
    state: ClipState
    format: str | None
    sha256: str
    person: str | None
    task: str | None
    words: list[str]
    captions: list[str] = Field(description="Sentences that describe the motion.")
    license: str | None
    source: str | None
    metadata: Metadata = Field(description="Values of your own, by key.")
    frames: int | None
    frame_rate: float | None = Field(description="Frames per second, as used.")
    declared_frame_rate: float | None = Field(description="Frames per second, as the file says.")
    duration: float | None = Field(description="Seconds.")
    start_offset: float | None = Field(
        description="Seconds from the start of the file to the clip's first frame. Add them to a"
        " time of the clip to find it in your own program. It is 0 unless frames at the start have"
        " no body, or the animation begins later; negative if the animation begins before 0 s."
    )
    joints: int | None = Field(description="Number of joints.")
    travel: float | None = Field(description=TRAVEL)
    speed: float | None = Field(description=SPEED)
    energy: float | None = Field(description=ENERGY)
    tempo: float | None = Field(description=f"{TEMPO} null without beats.")
    roles: dict[str, str] = Field(description="Joint name by joint role.")
    missing_roles: list[str]
    warnings: list[ClipWarning]
    created_at: datetime
    has_audio: bool = Field(description="Whether the clip has a recording: GET .../audio.")
    audio_offset: float | None = Field(
        validation_alias="audio_begins_at",
        description="Time in the motion at which the recording begins, seconds, as given or"
        " estimated. An estimate may be wrong by whole beats: the warning `audio_offset_estimated`"
        " gives the length of a beat, and the probability that the estimate is right.",
    )
    error: StoredProblem = Field(description="The reason why the clip is `failed`, else null.")
    reanalysis: Reanalysis | None = Field(
        description="State of a new analysis of a ready clip, after a change of the clip or of"
        " Kinedex. It is null when the new analysis is done. Until then, searches use the earlier"
        " analysis. After `failed` they still use it, and a warning gives the reason."
    )
    origin: ClipOrigin | None = Field(
        description="Of a clip that an edit made (`POST /v1/clips/{id}/edits`), else null."
    )


class ClipCreated(Outgoing):
    """A stored clip, and the job that will make it ready."""

    clip: Clip
    job: Job | None
    differences: list[Difference] = Field(
        description="If the library had the same bytes already: what came with other values."
    )


class ClipList(Paged):
    """A page of clips."""

    items: list[Clip]


class ClipForm(Incoming):
    """The text fields that come with an uploaded clip."""

    name: Label | None = Field(None, description="Default: the file's name.")
    person: Label | None = Field(None, examples=["anna"])
    task: Label | None = Field(None, examples=["walk"])
    words: FormWords | None = Field(
        None,
        description="Separated by spaces. In a phrase, underscores replace spaces.",
        examples=["walk slow"],
    )
    captions: FormCaptions | None = Field(
        None,
        description="Sentences that describe the motion, one a line (or separated by |). Their "
        "words teach the word model like `words`.",
        examples=["somebody walks slowly and turns left"],
    )
    license: Label | None = Field(None, examples=["CC-BY-4.0"])
    source: Label | None = None
    metadata: Json[MetadataChanges] | None = Field(
        None,
        description='JSON: values of your own by key, as in {"condition": "fatigued", "age": 30}.',
    )
    path: Path | None = Field(
        None,
        description="Where the file was, relative to a folder of yours, as in `cmu/02/02_01.bvh`.",
    )
    on_conflict: Literal["keep", "update", "error"] = Field(
        "keep",
        description="If the library has the same bytes already, with other labels or hints: keep"
        " the stored values; update them; or answer 409 and change nothing. `differences` lists"
        " the fields. A field that is not sent stays as it is.",
    )
    frame_rate: FileFrameRate = None
    unit: Unit = None
    up_axis: UpAxis | None = None
    roles: FormRoles = None
    stack: Stack | None = None
    audio_offset: Offset | None = Field(None, description=f"{_OFFSET} Default: estimated.")
    tempo: Tempo | None = Field(None, description="Beats per minute, if known.")
    beats: FormBeats | None = Field(
        None,
        description="Seconds, separated by spaces, as in `0.5 1.1`. They replace all other beats.",
    )

    def labels(self) -> dict[str, Any]:
        """The labels and hints that were sent."""
        sent = self.model_dump(exclude_unset=True, exclude={"path", "on_conflict"})
        return {name: value for name, value in sent.items() if value is not None}


class ClipPatch(Incoming):
    """Corrections. Only the sent fields change. null deletes a value (not for `name`)."""

    name: Annotated[Label, Field(json_schema_extra=NAMED)] | None = Field(
        None, json_schema_extra=not_null
    )
    person: Label | None = None
    task: Label | None = None
    words: Words | None = None
    captions: Captions | None = Field(
        None, description="Sentences that describe the motion; they replace all earlier ones."
    )
    license: Label | None = None
    source: Label | None = None
    metadata: MetadataChanges | None = Field(
        None,
        description="Only the sent keys change. null deletes a key; null instead of the object"
        " deletes all.",
    )
    frame_rate: FrameRate | None = Field(
        None, description="The clip is analyzed again. null restores the declared frame rate."
    )
    up_axis: UpAxis | None = Field(
        None,
        description="The axis of the file that points up. The clip is analyzed again. With null, it"
        " is found as after an upload.",
    )
    stack: Label | None = Field(
        None,
        description="The animation stack of an FBX file. The clip is analyzed again. null"
        " restores the longest stack.",
    )
    audio_offset: Offset | None = Field(
        None, description=f"{_OFFSET} The clip is analyzed again. With null, it is estimated."
    )
    tempo: Tempo | None = Field(
        None, description="Beats per minute. The clip is analyzed again. null deletes the tempo."
    )
    beats: list[Seconds] | None = Field(
        None,
        max_length=MAX_KEYPOSES,
        description="Seconds. They replace all other beats. The clip is analyzed again. null or"
        " an empty list deletes them.",
    )

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"person": "anna", "words": ["walk", "slow"]}]}
    )


class ClipQuery(Filter):
    """Filters of a list of clips, as in a search. A clip must pass all given filters."""

    state: ClipState | None = None
    missing: list[Literal["person", "task", "words"]] = Field(
        default_factory=list,
        max_length=len(MISSABLE),
        description="Only clips that lack at least one of these labels.",
    )
    has_warnings: bool | None = Field(
        None, description="true: only clips with warnings; false: only clips without."
    )
    q: PartOfName | None = Field(
        None, description="Part of the name, of the path, or of a text of the metadata."
    )
    sort: Sort = Field("-created_at", description="A minus sign at the start reverses the order.")
    limit: Limit = 10
    cursor: Cursor | None = None
    fields: Fields | None = None

    def as_filter(self) -> ClipFilter:
        """The filter of the store."""
        states = () if self.state is None else (self.state,)
        return replace(
            parse_filter(self.given()),
            state=states,
            missing=tuple(self.missing),
            has_warnings=self.has_warnings,
            q=self.q,
        )
