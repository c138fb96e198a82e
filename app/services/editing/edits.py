"""Edits that make new clips: the copy says where it comes from, and carries the labels over.

The file of the copy is a BVH with the rotations of the original's file, if it has any, else with
solved ones. The same edit of the same clip gives the same bytes, so it is stored once.
"""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import fields as fields_of
from dataclasses import replace

from app.formats.bvh.export import bvh_name, write_animation_bvh
from app.motion.editing.edited import Edited
from app.services import fields
from app.services.clips import catalogue
from app.services.clips.catalogue import Created
from app.services.editing.sided_texts import exchanged_labels
from app.services.editing.steps import EditStep, Result, apply, checked_steps
from app.services.library.library import Library
from app.services.library.ready_clips import read_ready_clip, ready_clip
from app.services.library.stored_motion import load_motion
from app.services.views.clip_rotations import own_animation
from app.store import audit
from app.store.clips import keypose_annotations
from app.store.clips.record import AnalysisHints, ClipLabels, ClipOrigin, ClipRecord, NewClip

METERS_PER_UNIT = 0.01
"""Of the files that are written: centimeters."""


def edit_clip(
    lib: Library, clip_id: str, steps: Sequence[EditStep], name: str | None = None
) -> Created:
    """Edit a ready clip, store the result as a new clip and queue its analysis.

    steps: done one after the other. name: of the new clip, by default made from the original's and
    the steps. The recording, the beats and the annotated keyposes go with the part that is kept.
    Raises BadField, ClipNotFound, ClipNotReady, TooShort, DiskFull.
    """
    asked = checked_steps(steps)
    given_name = fields.text("name", name)
    clip = ready_clip(lib, clip_id)
    motion = load_motion(lib, clip)
    animation = own_animation(lib, clip, motion, motion.frame_rate)
    result = apply(Edited(animation, motion.roles), asked, lib.settings.max_frames)
    content = b"".join(write_animation_bvh(result.edited.animation))
    limit = lib.settings.max_upload_bytes
    with lib.store.files.stage(io.BytesIO(content), max_bytes=limit) as staged:
        with lib.store.write() as tx:
            # Read again: a person who was forgotten meanwhile must not come back with the copy.
            now = read_ready_clip(tx, clip_id)
            new = _new_clip(now, result, staged.sha256, len(content), given_name)
            catalogue.keep(staged)
            created = catalogue.add(tx, new)
            kinds = [step["kind"] for step in result.done]
            audit.note(new_clip_id=created.clip.id, steps=kinds)
            times = _kept_times(keypose_annotations.get(tx, clip_id) or (), result)
            if created.is_new and times:
                keypose_annotations.put(tx, created.clip.id, times)
        return created


def _new_clip(
    clip: ClipRecord, result: Result, sha256: str, size: int, name: str | None
) -> NewClip:
    labels = ClipLabels(
        **{field.name: getattr(clip, field.name) for field in fields_of(ClipLabels)}
    )
    if result.is_mirrored:
        labels = exchanged_labels(labels)
    labels = replace(labels, name=name or _name(labels.name, result))
    return NewClip(
        sha256=sha256,
        file_name=fields.file_name(f"{labels.name}.bvh"),
        file_size=size,
        labels=labels,
        hints=_hints(clip, result),
        audio=clip.audio,
        origin=ClipOrigin(clip.id, result.done),
    )


def _name(name: str, result: Result) -> str:
    kinds = ", ".join(str(step["kind"]).replace("_", " ") for step in result.done)
    ending = f" ({kinds})"
    return name[: fields.MAX_TEXT - len(ending)] + ending


def _hints(clip: ClipRecord, result: Result) -> AnalysisHints:
    skeleton = result.edited.animation.skeleton
    beats = _kept_times(clip.hints.beats or (), result)
    begins_at = clip.audio_begins_at
    return AnalysisHints(
        metres_per_unit=METERS_PER_UNIT,
        up_axis="y",
        roles={
            role.value: bvh_name(skeleton.names[joint])
            for role, joint in result.edited.roles.items()
        },
        audio_offset=None if begins_at is None else begins_at - result.begins,
        tempo=clip.hints.tempo,
        beats=beats or None,
    )


def _kept_times(times: Sequence[float], result: Result) -> tuple[float, ...]:
    """The times of the original that lie in the part that is kept, as times of the copy."""
    kept = (time - result.begins for time in times if result.begins <= time < result.ends)
    return tuple(kept)
