"""Random dances: a dancer, beats, keyposes on beats, and the music.

The task `dance` of the demo has few figures and a steady tempo. Here, a seed determines everything:
the dancer, poses, rhythm, drift of the tempo, beats without a stop, freezes, ornaments and noise.
The clip contains the true beats and keyposes.
"""

from __future__ import annotations

from dataclasses import replace
from math import radians

import numpy as np

from app.demo.actors import ACTORS, Actor
from app.demo.clip import DemoClip
from app.demo.controls import Arm, Controls, Turn, along_arc, standing_controls
from app.demo.dances.counts import STOPPING, Counts, Manner, make_counts
from app.demo.dances.ornaments import with_ornaments
from app.demo.dances.poses import (
    CROUCH,
    HEAD,
    HIPS,
    LEFT_ARM,
    RIGHT_ARM,
    TRUNK,
    draw_poses,
    weights,
    with_part_lag,
)
from app.demo.dances.sound import Sound, record
from app.demo.dances.steps import foot_curves, footwork
from app.demo.posing import local_rotations, lowered_to_reach
from app.demo.rig import SIDES, build_rig, skeleton_of
from app.demo.take import Take, with_body_sway
from app.demo.words import words_for
from app.formats.bvh.writer import write_bvh
from app.formats.npz.writer import write_npz
from app.motion.skeleton.kinematics import forward_kinematics, local_translations
from app.numerics.arrays import FloatArray

UNITS_PER_METER = 100.0
BEATS_AT_END = 0.7
"""The time from the end of the last keypose to the end of the clip, in beats."""

LAGS = {"hips": -0.02, "trunk": 0.0, "head": -0.04, "left": 0.015, "right": 0.015}
"""Seconds by which parts of the body move later than the trunk; negative: earlier."""


def dance(
    seed: int,
    *,
    bpm: float = 100.0,
    seconds: float = 24.0,
    noise_mm: float = 0.0,
    drift: float = 0.0,
    manner: Manner = STOPPING,
    actor: Actor | None = None,
    sound: Sound | None = None,
    audio_offset: float | None = None,
) -> DemoClip:
    """A dance of about `seconds`. The same arguments give the same dance.

    bpm: beats per minute. noise_mm: standard deviation of white noise on each coordinate of each
    joint; with noise, the clip is an NPZ file of positions, else a BVH file. drift: the largest
    relative difference of the tempo from `bpm`. manner: how the dancer moves. actor: None draws
    one. sound: the kind of the recording; it does not change the motion. audio_offset: the time of
    the motion, in seconds, at which the recording begins; None draws one.
    """
    draw = np.random.RandomState(seed)
    dancer = actor or _random_dancer(draw)
    take = _take(draw, dancer)
    counts = make_counts(draw, bpm, seconds, manner, drift=drift)
    last = counts.moments[-1].leave + BEATS_AT_END * counts.interval
    times = take.clock(last)
    counts = replace(counts, beats=counts.beats[counts.beats < times[-1]])
    controls = _performed(draw, take, counts, times)
    controls = with_ornaments(controls, times, counts, draw, manner)
    controls = lowered_to_reach(with_body_sway(controls, take, times), take.rig, times)
    controls = along_arc(controls, take.heading, 0.0)
    stem = f"{dancer.name}/choreography_{seed:02d}"
    audio, start = b"", None
    if sound is not None:
        audio, start = record(seed, sound, counts, float(times[-1]), audio_offset)
    return DemoClip(
        path=f"{stem}.{'npz' if noise_mm else 'bvh'}",
        content=_content(draw, take, controls, noise_mm),
        person=dancer.name,
        task="dance",
        words=words_for("dance", dancer.name, seed, dancer.left_handed),
        frame_rate=dancer.frame_rate,
        keyposes=tuple(moment.time for moment in counts.held),
        beats=tuple(float(beat) for beat in counts.beats),
        holds=tuple((moment.arrive, moment.leave) for moment in counts.held),
        audio=audio,
        audio_path=f"{stem}.wav" if audio else "",
        audio_offset=start,
    )


def _random_dancer(draw: np.random.RandomState) -> Actor:
    """One of the demo's actors with slightly changed body and style, at a usual frame rate."""
    actor = ACTORS[draw.randint(len(ACTORS))]
    body = replace(actor.body, stature=actor.body.stature * draw.uniform(0.95, 1.05))
    style = replace(actor.style, energy=actor.style.energy * draw.uniform(0.85, 1.15))
    rate = float(draw.choice([30.0, 60.0, 100.0, 120.0]))
    return replace(actor, body=body, style=style, frame_rate=rate)


def _take(draw: np.random.RandomState, actor: Actor) -> Take:
    return Take(
        actor=actor,
        rig=build_rig(actor),
        draw=draw,
        pace=1.0,
        size=float(np.clip(actor.style.energy, 0.7, 1.25)),
        phase=float(draw.uniform(0.0, 1.0)),
        heading=float(draw.uniform(-np.pi, np.pi)),
    )


def _performed(
    draw: np.random.RandomState, take: Take, counts: Counts, times: FloatArray
) -> Controls:
    """The poses and steps over time. Each part of the body has its own small lag."""
    rest, leg = standing_controls(take.actor, take.rig, len(times)), take.rig.leg
    turning = float(draw.choice([0.0, radians(12), radians(30)]))
    feet = footwork(draw, counts.moments, take.actor.style.stance, turning)
    size = float(np.clip(0.55 + 0.45 * take.size, 0.8, 1.05))
    poses = draw_poses(draw, counts.moments, rest.arms[0], size)
    curves = {
        part: weights(times, with_part_lag(counts.moments, draw, lag)) for part, lag in LAGS.items()
    }
    center = curves["hips"] @ feet.centers
    hips, trunk = curves["hips"] @ poses[:, HIPS], curves["trunk"] @ poses[:, TRUNK]
    head = curves["head"] @ poses[:, HEAD]
    root = rest.root.copy()
    root[:, [0, 2]] += leg * center[:, :2]
    root[:, 1] -= leg * (curves["hips"] @ poses[:, CROUCH])
    arms = [
        _arm(curves[part] @ poses[:, channels])
        for part, channels in (("left", LEFT_ARM), ("right", RIGHT_ARM))
    ]
    stepping = [foot_curves(times, rest.feet[side], side, feet.steps, leg) for side in SIDES]
    return replace(
        rest,
        root=root,
        pelvis=_plus(rest.pelvis, hips[:, 0] + center[:, 2], hips[:, 1], hips[:, 2]),
        spine=_plus(rest.spine, trunk[:, 0], trunk[:, 1], trunk[:, 2]),
        head=_plus(rest.head, head, -0.5 * trunk[:, 1], 0.15 * head),
        arms=(arms[0], arms[1]),
        feet=(stepping[0], stepping[1]),
    )


def _plus(turn: Turn, yaw: FloatArray, pitch: FloatArray, roll: FloatArray) -> Turn:
    return Turn(turn.yaw + yaw, turn.pitch + pitch, turn.roll + roll)


def _arm(curves: FloatArray) -> Arm:
    """An arm with `curves` (frames, 5). The elbow must not bend backward if a curve overshoots."""
    flex, abduct, twist, elbow, wrist = curves.T
    return Arm(flex, abduct, twist, np.maximum(elbow, 0.03), wrist)


def _content(draw: np.random.RandomState, take: Take, controls: Controls, noise_mm: float) -> bytes:
    """BVH in centimeters; with noise, NPZ with positions in meters.

    Noise changes the lengths of bones, and BVH has constant lengths.
    """
    rotations, rate = local_rotations(controls, take.rig), take.actor.frame_rate
    if not noise_mm:
        skeleton = skeleton_of(take.rig, take.actor.naming, UNITS_PER_METER)
        return write_bvh(skeleton, rotations, controls.root * UNITS_PER_METER, rate)
    skeleton = skeleton_of(take.rig, take.actor.naming, 1.0)
    moved = local_translations(skeleton, controls.root)
    positions = forward_kinematics(skeleton, rotations, moved)
    positions += 1e-3 * noise_mm * draw.standard_normal(positions.shape)
    return write_npz(skeleton.names, skeleton.parents, positions, rate)
