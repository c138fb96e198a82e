"""Dances by seed: a dancer, beats, keyposes on them, and a recording of what was danced to.

The demo's task `dance` has few figures and a steady tempo. For these dances, everything is drawn
anew for each seed: dancer, poses, rhythm, drift of the tempo, beats without a stop, freezes,
ornaments and noise. The intended beats and keyposes come with the clip.
"""

from __future__ import annotations

from dataclasses import replace
from math import radians

import numpy as np

from app.demo.actors import ACTORS, Actor
from app.demo.clip import DemoClip
from app.demo.controls import Arm, Controls, Turn, bent, standing
from app.demo.dances.counts import Counts, counted
from app.demo.dances.ornaments import ornamented
from app.demo.dances.poses import (
    CROUCH,
    HEAD,
    HIPS,
    LEFT_ARM,
    RIGHT_ARM,
    TRUNK,
    draw_poses,
    loosened,
    weights,
)
from app.demo.dances.sound import Sound, record
from app.demo.dances.steps import footwork, stepped
from app.demo.posing import local_rotations, within_reach
from app.demo.rig import SIDES, build_rig, skeleton_of
from app.demo.take import Take, enlivened
from app.demo.words import words_for
from app.formats.bvh.writer import write_bvh
from app.formats.npz.writer import write_npz
from app.motion.skeleton.kinematics import forward_kinematics, local_translations
from app.numerics.arrays import FloatArray

UNITS_PER_METER = 100.0
AFTERWARDS = 0.7
"""How many beats follow after the last keypose."""

LAGS = {"hips": -0.02, "trunk": 0.0, "head": -0.04, "left": 0.015, "right": 0.015}
"""About how many seconds parts of the body follow the trunk."""


def dance(
    seed: int,
    *,
    bpm: float = 100.0,
    seconds: float = 24.0,
    noise_mm: float = 0.0,
    drift: float = 0.0,
    passes: float = 0.15,
    freezes: float = 0.04,
    ornaments: float = 1.0,
    actor: Actor | None = None,
    sound: Sound | None = None,
    audio_offset: float | None = None,
) -> DemoClip:
    """A dance of about `seconds`, the same for the same arguments.

    noise_mm: standard deviation of white noise on every coordinate of every joint; then the
    clip is an NPZ file of positions, else BVH. drift: greatest relative departure of the
    tempo from `bpm`; passes, freezes: share of beats without a stop, or with a long one;
    ornaments: factor on what is danced beside the poses. sound: what is recorded with it,
    from `audio_offset` s of the motion on (drawn where None); it changes nothing else.
    """
    draw = np.random.RandomState(seed)
    dancer = actor or _dancer(draw)
    take = _take(draw, dancer)
    counts = counted(draw, bpm, seconds, drift=drift, passes=passes, freezes=freezes)
    last = counts.moments[-1].leave + AFTERWARDS * counts.interval
    times = take.clock(last)
    counts = replace(counts, beats=counts.beats[counts.beats < times[-1]])
    controls = _performed(draw, take, counts, times)
    controls = ornamented(controls, times, counts, draw, ornaments)
    controls = within_reach(enlivened(controls, take, times), take.rig, times)
    controls = bent(controls, take.heading, 0.0)
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


def _dancer(draw: np.random.RandomState) -> Actor:
    """One of the demo's people, somewhat changed, recorded at some usual rate."""
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
    """Poses and steps over time, each part of the body with its own small lag."""
    rest, leg = standing(take.actor, take.rig, len(times)), take.rig.leg
    turning = float(draw.choice([0.0, radians(12), radians(30)]))
    feet = footwork(draw, counts.moments, take.actor.style.stance, turning)
    size = float(np.clip(0.55 + 0.45 * take.size, 0.8, 1.05))
    poses = draw_poses(draw, counts.moments, rest.arms[0], size)
    curves = {
        part: weights(times, loosened(counts.moments, draw, lag)) for part, lag in LAGS.items()
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
    placed = [stepped(times, rest.feet[side], side, feet.steps, leg) for side in SIDES]
    return replace(
        rest,
        root=root,
        pelvis=_plus(rest.pelvis, hips[:, 0] + center[:, 2], hips[:, 1], hips[:, 2]),
        spine=_plus(rest.spine, trunk[:, 0], trunk[:, 1], trunk[:, 2]),
        head=_plus(rest.head, head, -0.5 * trunk[:, 1], 0.15 * head),
        arms=(arms[0], arms[1]),
        feet=(placed[0], placed[1]),
    )


def _plus(turn: Turn, yaw: FloatArray, pitch: FloatArray, roll: FloatArray) -> Turn:
    return Turn(turn.yaw + yaw, turn.pitch + pitch, turn.roll + roll)


def _arm(curves: FloatArray) -> Arm:
    """An arm of curves (frames, 5); what overshoots never bends the elbow the wrong way."""
    flex, abduct, twist, elbow, wrist = curves.T
    return Arm(flex, abduct, twist, np.maximum(elbow, 0.03), wrist)


def _content(draw: np.random.RandomState, take: Take, controls: Controls, noise_mm: float) -> bytes:
    """BVH in centimeters; with noise, which no skeleton has, positions in meters."""
    rotations, rate = local_rotations(controls, take.rig), take.actor.frame_rate
    if not noise_mm:
        skeleton = skeleton_of(take.rig, take.actor.naming, UNITS_PER_METER)
        return write_bvh(skeleton, rotations, controls.root * UNITS_PER_METER, rate)
    skeleton = skeleton_of(take.rig, take.actor.naming, 1.0)
    moved = local_translations(skeleton, controls.root)
    positions = forward_kinematics(skeleton, rotations, moved)
    positions += 1e-3 * noise_mm * draw.standard_normal(positions.shape)
    return write_npz(skeleton.names, skeleton.parents, positions, rate)
