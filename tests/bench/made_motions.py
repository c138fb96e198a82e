"""Clips of the bench of synthesis, and motions that are made of them as the service does."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.motion_shape import moments_of, motion_shape
from app.formats.read import read_recording
from app.models.held_out.synthesis import NEW_PERSON, NEW_TASK, Trial, synthesized
from app.models.synthesis.body import Donor, embody, same_body
from app.models.synthesis.model import Synthesis, fit_synthesis
from app.models.synthesis.motion import course_of
from app.motion.canonical.canonical import canonicalize
from app.motion.frame.body_frame import ANALYSIS_RATE, BodyTrack, body_track
from app.motion.motion import Motion
from app.motion.posing.file_rotations import animation_of_recording
from app.motion.skeleton.animation import Animation
from app.motion.skeleton.recording import Recording
from tests.real_clips import manifest, real_clips


@dataclass(frozen=True)
class Clip:
    person: str
    task: str
    path: str
    motion: Motion
    track: BodyTrack
    shape: np.ndarray
    recording: Recording


def clip_of(path: str, person: str, task: str, content: bytes, fps: float | None = None) -> Clip:
    recording = read_recording(content)
    motion = canonicalize(recording, frame_rate=fps)
    track = body_track(motion)
    return Clip(person, task, path, motion, track, motion_shape(track), recording)


def real_motions() -> list[Clip]:
    """The real BVH clips with a person."""
    rows = [row for row in manifest() if row["path"].endswith(".bvh") and row["person"]]
    return [
        clip_of(
            row["path"],
            row["person"],
            row["task"],
            (real_clips() / row["path"]).read_bytes(),
            float(row["fps"]),
        )
        for row in rows
    ]


def fitted(clips: list[Clip]) -> Synthesis:
    shapes = np.stack([clip.shape for clip in clips])
    return fit_synthesis(shapes, [clip.person for clip in clips], [clip.task for clip in clips])


def made(record: Synthesis, clips: list[Clip], kind: str, trial: Trial) -> Motion:
    """Make the motion as the service does, without the clips of the cell itself."""
    predicted = synthesized(record, kind, trial)
    shape = predicted.shape
    away = record.distances(shape)
    tasks = trial.given if kind == NEW_PERSON else record.tasks
    own = [
        i
        for i, clip in enumerate(clips)
        if clip.person == trial.person and clip.task in tasks and clip.task != trial.task
    ]
    others = trial.given if kind == NEW_TASK else record.persons
    if predicted.follows is not None:
        others = (predicted.follows,)
    takes = [
        i
        for i, clip in enumerate(clips)
        if clip.task == trial.task and clip.person in others and clip.person != trial.person
    ]
    donors = same_body([_donor(clips[i]) for i in sorted(own, key=lambda i: away[i])[:5]])
    take, take_shape = None, None
    if shape[-1] < 0.5:
        nearest = clips[min(takes, key=lambda i: away[i])]
        take, take_shape = moments_of(nearest.track), nearest.shape
    length = float(np.median([donor.track.body_length for donor in donors]))
    course = course_of(shape, length, take=take, take_shape=take_shape)
    return _as_motion(embody(course, donors), donors[0])


def _donor(clip: Clip) -> Donor:
    animation = animation_of_recording(clip.recording, clip.motion)
    assert animation is not None
    return Donor(animation.resampled(ANALYSIS_RATE), clip.track, dict(clip.motion.roles))


def _as_motion(animation: Animation, donor: Donor) -> Motion:
    skeleton = animation.skeleton
    return Motion(
        "bvh",
        skeleton.names,
        skeleton.parents,
        animation.positions().astype(np.float32),
        donor.joints,
        (),
        ANALYSIS_RATE,
        ANALYSIS_RATE,
        1.0,
    )
