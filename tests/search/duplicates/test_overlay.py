"""Overlays: shifts of known cuts, a plain search as the slow twin, and the kinds of pairs."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.analyze import describe_for_search
from app.analysis.descriptors.moments import mirrored, moments
from app.motion.frame.body_frame import smooth_track
from app.motion.motion import Motion
from app.motion.roles.joint_roles import SUN_ROLES
from app.numerics.arrays import FloatArray
from app.search.duplicates import overlay as module
from app.search.duplicates.kinds import ClipFacts, PairKind, kind_of
from app.search.duplicates.overlay import mirrored_features, overlay
from tests.bodies import motion_of, walking, waving

FACTS = ClipFacts(8.0, 30.0, "bvh", 13)


def dance(seed: int = 0, frames: int = 240) -> FloatArray:
    """(frames, 13, 3) a body whose joints wander smoothly: no two parts are alike."""
    rng = np.random.default_rng(seed)
    times = np.arange(frames) / 30
    body = walking(frames / 30)[:frames].copy()
    for _ in range(6):
        size, phase = rng.normal(scale=0.05, size=(13, 3)), rng.uniform(0, 6, size=(13, 3))
        body += size * np.sin(rng.uniform(1, 5, size=(13, 3)) * times[:, None, None] + phase)
    return body


def features(motion: Motion) -> FloatArray:
    return describe_for_search(motion, ["features_10hz"]).arrays["features_10hz"]


def mirror(body: FloatArray) -> FloatArray:
    order = [SUN_ROLES.index(role.mirrored()) for role in SUN_ROLES]
    return (body * np.array([-1.0, 1.0, 1.0]))[:, order]


@pytest.mark.parametrize("first", [0, 31, 77])
def test_a_cut_lies_where_it_was_cut(first: int) -> None:
    body = dance()
    found = overlay(features(motion_of(body)), features(motion_of(body[first : first + 120])))
    assert found is not None
    assert found.shift == pytest.approx(first / 30, abs=0.03)
    assert found.distance < 0.05
    assert found.seconds == pytest.approx(4.0, abs=0.25)
    part = ClipFacts(4.0, 30.0, "bvh", 13)
    assert kind_of(FACTS, part, found, is_mirrored=False) is PairKind.CUT


def test_the_best_shift_is_that_of_a_plain_search() -> None:
    rng = np.random.default_rng(2)
    for _ in range(5):
        x, y = (np.cumsum(rng.normal(size=(n, 43)), axis=0) for n in (50, 37))
        shortest = 20
        distances = {
            shift: module._difference(x, y, float(shift), shortest)
            for shift in range(shortest - len(y), len(x) - shortest + 1)
        }
        best = min((found[0], shift) for shift, found in distances.items() if found is not None)
        assert module._best_shift(x, y, shortest) == best[1]


def test_mirrored_features_are_those_of_mirrored_motion() -> None:
    body = dance()
    exchanged = features(motion_of(mirror(body)))
    np.testing.assert_allclose(mirrored_features(features(motion_of(body))), exchanged, atol=2e-3)
    track, other = smooth_track(motion_of(body)), smooth_track(motion_of(mirror(body)))
    own, theirs = moments(track), moments(other)
    np.testing.assert_allclose(own[:, 0], theirs[:, 0])
    np.testing.assert_allclose(mirrored(own[:, 1:]), theirs[:, 1:], atol=1e-3)


@pytest.mark.parametrize(
    ("other", "kind"),
    [
        (FACTS, PairKind.EXACT),
        (ClipFacts(8.0, 60.0, "bvh", 13), PairKind.RATE),
        (ClipFacts(8.0, 30.0, "glb", 13), PairKind.FORMAT),
        (ClipFacts(8.0, 30.0, "bvh", 31), PairKind.FORMAT),
    ],
)
def test_the_kind_of_a_whole_copy(other: ClipFacts, kind: PairKind) -> None:
    own = features(motion_of(dance()))
    found = overlay(own, own)
    assert found is not None
    assert kind_of(FACTS, other, found, is_mirrored=False) is kind
    assert kind_of(FACTS, other, found, is_mirrored=True) is PairKind.MIRROR


def test_a_noisy_copy_is_a_copy_and_another_dance_is_none() -> None:
    body = dance()
    noisy = body + np.random.default_rng(0).normal(scale=0.01, size=body.shape)
    found = overlay(features(motion_of(body)), features(motion_of(noisy)))
    assert found is not None
    assert kind_of(FACTS, FACTS, found, is_mirrored=False) is PairKind.COPY
    for seed in (1, 2, 3):
        other = overlay(features(motion_of(body)), features(motion_of(dance(seed))))
        assert other is not None
        assert kind_of(FACTS, FACTS, other, is_mirrored=False) in (None, PairKind.SIMILAR)


def test_clips_that_are_too_short_have_no_overlay() -> None:
    own = features(motion_of(waving(4.0)))
    assert overlay(own, own[:2]) is None
