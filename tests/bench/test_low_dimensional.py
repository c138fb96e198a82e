"""Keyposes against uniform poses on real clips (Perera 2009, section 4).

Run: pytest -m bench -s tests/bench/test_low_dimensional.py
Only the limits of plausible poses were fitted, on every second clip (by name). Their figures are
measured on the other clips.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from sklearn.metrics import silhouette_score

from app.analysis.keyposes.keyposes import find_keyposes
from app.analysis.low_dimensional.eigen_motion import (
    Basis,
    EigenModel,
    eigen_model,
    low_dimensional,
    reconstruction_errors,
    uniform_frames,
)
from app.analysis.low_dimensional.plausibility import judge_poses
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.motion.frame.body_frame import BodyTrack, body_track
from app.numerics.arrays import FloatArray
from app.numerics.clusteredness import clusteredness
from tests.bench.page import Section
from tests.bodies import motion_of
from tests.cyclic_dances import cyclic_dance
from tests.real_clips import manifest, real_clips

FIGURES = Section(
    "low_dimensional",
    "Keyposes against uniform poses in few dimensions",
    trials="all real clips with at least four keyposes",
)

pytestmark = pytest.mark.bench

SHOWN = ("salsa_01", "salsa_02", "salsa_03", "indian_04", "indian_06", "walk_normal_001")
ROWS = 10


def _stem(row: dict[str, str]) -> str:
    return Path(row["path"]).stem


@lru_cache(maxsize=600)
def _track(path: str, fps: str) -> BodyTrack:
    """fps: from the manifest, because some files declare a wrong one."""
    recording = read_recording((real_clips() / path).read_bytes())
    return body_track(canonicalize(recording, frame_rate=float(fps) if fps else None))


def _readable() -> list[dict[str, str]]:
    """The clips that one file describes completely, by name."""
    rows = [row for row in manifest() if not row["path"].endswith((".amc", ".asf"))]
    return sorted(rows, key=_stem)


def _models(track: BodyTrack) -> dict[Basis, EigenModel] | None:
    frames = find_keyposes(track).frames
    if len(frames) < 4:
        return None
    uniform = uniform_frames(track.frames, len(frames))
    return {
        Basis.KEYPOSE: eigen_model(track.local[frames]),
        Basis.UNIFORM: eigen_model(track.local[uniform]),
    }


def _line(name: str, values: Sequence[float] | FloatArray, form: str) -> str:
    return f"    {name:22}" + "".join(f"{value:>{form}}" for value in values[:ROWS])


def test_variance_and_error_of_dances_and_a_walk() -> None:
    rows = {_stem(row): row for row in _readable()}
    for name in SHOWN:
        track = _track(rows[name]["path"], rows[name]["fps"])
        models = _models(track)
        assert models is not None
        least = 1000 * reconstruction_errors(eigen_model(track.local), track)
        FIGURES.print(f"\n{name}: {track.duration:.0f} s, {models[Basis.KEYPOSE].poses} keyposes")
        for basis, model in models.items():
            errors = 1000 * reconstruction_errors(model, track)
            FIGURES.print(_line(f"variance, {basis}", model.variance_kept(), "7.3f"))
            FIGURES.print(_line(f"error mm, {basis}", errors, "7.1f"))
            reached = errors[: len(least)]
            assert (reached >= least[: len(reached)] - 1e-6).all()
        FIGURES.print(_line("error mm, all frames", least, "7.1f"))


def test_keyposes_keep_more_of_their_own_and_less_of_the_motion() -> None:
    """Means over real clips with at least four keyposes, K' = 3."""
    kept: dict[Basis, list[float]] = {basis: [] for basis in Basis}
    errors: dict[Basis, list[float]] = {basis: [] for basis in Basis}
    silhouettes: dict[Basis, list[float]] = {basis: [] for basis in Basis}
    for row in _readable()[::3]:
        track = _track(row["path"], row["fps"])
        models = _models(track)
        if models is None:
            continue
        frames = find_keyposes(track).frames
        for basis, model in models.items():
            own = frames if basis is Basis.KEYPOSE else uniform_frames(track.frames, len(frames))
            found = clusteredness(model.coordinates(track.local[own], 3))
            kept[basis].append(float(model.variance_kept()[2]))
            errors[basis].append(1000 * float(reconstruction_errors(model, track)[2]))
            silhouettes[basis].append(found.clusters.silhouette if found else 0.0)
    FIGURES.print(f"\n{len(kept[Basis.KEYPOSE])} clips, 3 dimensions")
    for basis in Basis:
        means = [np.mean(figures[basis]) for figures in (kept, errors, silhouettes)]
        FIGURES.print(
            "{:10} variance {:.3f}  error {:5.1f} mm  silhouette {:.3f}".format(basis, *means)
        )
    better = np.mean(np.array(errors[Basis.KEYPOSE]) < errors[Basis.UNIFORM])
    FIGURES.print(f"keyposes draw the motion better in {better:.0%} of the clips")
    assert np.mean(kept[Basis.KEYPOSE]) > np.mean(kept[Basis.UNIFORM])
    assert np.mean(silhouettes[Basis.KEYPOSE]) > np.mean(silhouettes[Basis.UNIFORM])
    # People preferred keyposes (Perera, Table 2), but uniform poses have the smaller error.
    assert np.mean(errors[Basis.KEYPOSE]) > np.mean(errors[Basis.UNIFORM])


def test_real_poses_are_hardly_ever_implausible() -> None:
    """Frames of the real clips that were not used to choose the limits."""
    counts = {"original": 0, **{basis.value: 0 for basis in Basis}}
    frames = drawn = 0
    for row in _readable()[::2]:
        track = _track(row["path"], row["fps"])
        found = judge_poses(track.local).count
        frames += track.frames
        counts["original"] += found
        models = _models(track)
        if models is None:
            continue
        drawn += track.frames
        for basis, model in models.items():
            counts[basis.value] += judge_poses(low_dimensional(model, track, 3).local).count
    FIGURES.print(
        f"\nimplausible: original {counts['original']} of {frames} frames; at 3 dimensions", end=""
    )
    FIGURES.print(f" keypose {counts['keypose']}, uniform {counts['uniform']} of {drawn}")
    assert counts["original"] < 0.003 * frames


def test_the_same_keyposes_of_eight_dancers_cluster() -> None:
    """Figures 7 and 8: poses of one cycle of each of eight dancers, with their index in the cycle.

    The dances are generated, because real clips do not say which keyposes are the same.
    """
    own: dict[Basis, list[float]] = {basis: [] for basis in Basis}
    for seed in range(2000, 2010):
        poses: dict[Basis, list[FloatArray]] = {basis: [] for basis in Basis}
        for dancer in range(8):
            dance = cyclic_dance(
                seed, poses=8, times=1, dancer=dancer, drift=0.1, change=0.3, tempo=80 + 5 * dancer
            )
            track = body_track(motion_of(dance.positions, dance.rate))
            stops = np.round(np.array(dance.stops[3:12]) * track.rate).astype(int)
            uniform = stops[0] + uniform_frames(stops[-1] - stops[0], 8)
            poses[Basis.KEYPOSE].append(track.local[stops[:8]])
            poses[Basis.UNIFORM].append(track.local[uniform])
        for basis, each in poses.items():
            rows = np.concatenate(each)
            points = eigen_model(rows).coordinates(rows, 3)
            own[basis].append(silhouette_score(points, np.tile(np.arange(8), 8)))
    silhouettes = {basis: float(np.mean(values)) for basis, values in own.items()}
    FIGURES.print(
        "\nsilhouette of poses by their number: "
        + ", ".join(f"{b} {v:.3f}" for b, v in silhouettes.items())
    )
    assert silhouettes[Basis.KEYPOSE] > silhouettes[Basis.UNIFORM]
