"""Keyposes, segments, low-dimensional motions and searches have the same keyposes of a clip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.models.keyposes.thresholds import KeyposeThresholds, Thresholds
from app.motion.roles.joint_roles import JointRole
from app.services.clips import catalogue as clips
from app.services.find import find
from app.services.library.library import Library
from app.services.training.models import request_fit
from app.services.views.keyposes import ThresholdSource, annotate_keyposes, view
from app.services.views.low_dimensional import Reduction, keyposes_of, reduce
from app.services.views.segments import list_segments
from app.store import models
from app.store.jobs.record import JobKind
from app.store.jobs.repository import list_jobs
from tests.bodies import move_joint, standing
from tests.cyclic_dances import CyclicDance
from tests.libraries import work
from tests.queries import motion_query
from tests.services.dances import upload_dance


@dataclass(frozen=True)
class Answers:
    """Times of a clip's keyposes, seconds, by everything that knows them."""

    keyposes: tuple[float, ...]
    segments: tuple[float, ...]
    low_dimensional: tuple[float, ...]
    poses: tuple[float, ...]
    search: tuple[float, ...]


def rounded(times: object) -> tuple[float, ...]:
    return tuple(round(float(time), 3) for time in times)  # type: ignore[attr-defined]


def ask_all(lib: Library, clip_id: str) -> Answers:
    clip = clips.get_clip(lib, clip_id)
    spans = [(one.start, one.end) for one in list_segments(lib, clip_id).segments]
    query = motion_query(
        clip_id=clip_id, segment=0, scope="segments", include_self=True, limit=1000
    )
    hits = [hit for hit in find.find_motion(lib, query).items if hit.clip.id == clip_id]
    found = sorted({time for hit in hits for time in (hit.start, hit.end)})
    frames = keyposes_of(lib, clip)[clip_id]
    reduced = reduce(lib, clip, Reduction())
    return Answers(
        rounded(view(lib, clip_id).found.times),
        rounded([*(start for start, _ in spans), spans[-1][1]]),
        rounded(frame / 30 for frame in frames),
        rounded(pose.time for pose in reduced.poses),
        rounded(found),
    )


BEAT = 0.8
"""Seconds from one slow moment of the hand to the next."""


def circling(lib: Library, name: str, seconds: float) -> str:
    """Upload a motion whose right hand circles, stopping and only slowing down by turns.

    Only the stops are keyposes for the default thresholds.
    """
    rate = 60.0
    t = np.arange(round(seconds * rate) + 1) / rate
    depth = np.where((t / BEAT).astype(int) % 2 == 0, 0.98, 0.55)
    speed = 1 - depth * np.cos(np.pi * ((t / BEAT) % 1 - 0.5)) ** 4
    angle = 4.0 * np.cumsum(speed) / rate
    body = standing(len(t))
    around = np.stack([0.2 * np.cos(angle) - 0.1, 0.2 * np.sin(angle) + 0.5, 0 * t], axis=1)
    move_joint(body, JointRole.RIGHT_HAND, around)
    made = CyclicDance(body, rate, np.zeros(0), (), ())
    return upload_dance(lib, made, name, task="circle").id


def is_one_answer(found: Answers) -> bool:
    same = found.keyposes == found.segments == found.low_dimensional == found.poses
    # A search need not find every segment of a clip.
    return bool(same and found.search and set(found.search) <= set(found.keyposes))


def fit_and_analyze_again(lib: Library) -> int:
    """Fit the models and do all jobs that follow; returns how many analyses there were."""
    request_fit(lib)
    work(lib.settings)
    with lib.store.read() as tx:
        return len(list_jobs(tx, kind=JobKind.INGEST, limit=100).items)


def test_learned_thresholds_reach_every_answer_by_analyses_as_jobs(lib: Library) -> None:
    ids = [circling(lib, "one.npz", 12.0), circling(lib, "other.npz", 10.0)]
    work(lib.settings)
    before = ask_all(lib, ids[0])
    assert is_one_answer(before)
    # To this person, the slow moments are keyposes too.
    slow = np.arange(0.5 * BEAT, 9.0, BEAT)
    annotate_keyposes(lib, ids[1], slow.tolist())
    analyses = fit_and_analyze_again(lib)
    assert analyses == 2 * len(ids)
    after = ask_all(lib, ids[0])
    assert is_one_answer(after)
    assert len(after.keyposes) > 1.5 * len(before.keyposes)
    used = view(lib, ids[0]).thresholds
    assert (used.t1_source, used.model_version) == (ThresholdSource.LEARNED, 1)
    # The same thresholds are learned again, so nothing is analyzed again.
    assert fit_and_analyze_again(lib) == analyses
    assert ask_all(lib, ids[0]) == after


def test_there_is_one_answer_while_a_clip_waits_for_its_analysis(lib: Library) -> None:
    clip_id = circling(lib, "one.npz", 12.0)
    work(lib.settings)
    before = ask_all(lib, clip_id)
    arrays, meta = KeyposeThresholds({"rms": Thresholds(0.6, 0.8)}).to_arrays()
    with lib.store.write() as tx:
        models.save(
            tx, "keyposes", meta={"model": meta}, arrays=arrays, library_version=1, library_size=1
        )
    assert is_one_answer(before)
    assert ask_all(lib, clip_id) == before
    work(lib.settings)
    after = ask_all(lib, clip_id)
    assert is_one_answer(after)
    assert len(after.keyposes) > len(before.keyposes)
