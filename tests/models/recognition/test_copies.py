from __future__ import annotations

import numpy as np
import pytest

from app.analysis.analyze import describe_for_search
from app.errors import TooShort
from app.models.recognition.copies import (
    CUTS,
    DISTURBANCES,
    LIGHT,
    MAX_COPIED,
    CopiedClips,
    disturbed_copies,
    evenly_chosen,
)
from app.models.recognition.kinds import Disturbed
from app.models.recognition.views import BothViews
from tests.bodies import motion_of, walking, waving

KINDS = len(DISTURBANCES)
NOT_MIRRORED = len(LIGHT) + len(CUTS)


def described(positions: np.ndarray) -> np.ndarray:
    arrays = describe_for_search(motion_of(positions)).arrays
    return np.concatenate([arrays["motion_sample"], arrays["wide_motion_vector"]])


def test_copies_are_nearer_to_their_clip_than_another_motion_is() -> None:
    walk, wave = walking(turn=0.3), waving()
    copies = disturbed_copies(walk, seed=1)
    assert copies.shape == (KINDS, 1762)
    assert np.isfinite(copies).all()
    same = copies[:NOT_MIRRORED]
    apart = np.linalg.norm(same - described(walk), axis=1)
    assert (apart > 0).all()
    assert apart.max() < np.linalg.norm(same - described(wave), axis=1).min()


def test_copies_are_the_same_for_a_seed() -> None:
    walk = walking()
    np.testing.assert_array_equal(disturbed_copies(walk, 2), disturbed_copies(walk, 2))
    assert (disturbed_copies(walk, 2)[0] != disturbed_copies(walk, 3)[0]).any()


def test_a_copy_that_is_too_short_is_the_clip() -> None:
    brief = walking()[:3]
    copies = disturbed_copies(brief)
    np.testing.assert_array_equal(copies[NOT_MIRRORED - 1], described(brief))
    with pytest.raises(TooShort):
        disturbed_copies(walking()[:1])


@pytest.mark.parametrize("count", [0, 1, 7, MAX_COPIED, 3 * MAX_COPIED + 1])
def test_copied_clips_are_spread_evenly(count: int) -> None:
    chosen = evenly_chosen(count)
    assert len(chosen) == min(count, MAX_COPIED)
    steps = np.diff(chosen)
    assert steps.size == 0 or steps.max() - steps.min() <= 1
    assert count == 0 or (chosen[0] == 0 and chosen[-1] == count - 1)


def copied_clips() -> CopiedClips:
    rng = np.random.default_rng(0)
    clips = BothViews(rng.normal(size=(9, 4)), rng.normal(size=(9, 3)))
    copies = BothViews(rng.normal(size=(4, KINDS, 4)), rng.normal(size=(4, KINDS, 3)))
    return CopiedClips(clips, np.array([1, 3, 4, 8]), copies)


def test_moments_are_those_of_each_difference_summed_up() -> None:
    copied = copied_clips()
    for view, found in enumerate(copied.moments(np.array([0, 3, 4, 5]))):
        for kind, last in ((Disturbed.LIGHTLY, len(LIGHT)), (Disturbed.CUT, NOT_MIRRORED)):
            slow = [
                np.outer(delta, delta)
                for row, clip in ((1, 3), (2, 4))
                for delta in copied.copies[view][row, :last] - copied.clips[view][clip]
            ]
            np.testing.assert_allclose(found[kind], np.mean(slow, axis=0))


def test_clips_without_copies_give_no_moments() -> None:
    assert copied_clips().moments(np.array([0, 2])) == ({}, {})


def test_the_last_copy_is_mirrored() -> None:
    copied = copied_clips()
    clips, copies = copied.mirrored(np.array([0, 1, 4, 8]))
    assert clips.tolist() == [1, 4, 8]
    np.testing.assert_array_equal(copies.sample, copied.copies.sample[[0, 2, 3], -1])


def test_each_copied_clip_gives_one_light_copy() -> None:
    copied = copied_clips()
    clips, copies = copied.one_each(np.array([0, 1, 4, 8]))
    assert clips.tolist() == [1, 4, 8]
    np.testing.assert_array_equal(copies.wide, copied.copies.wide[[0, 2, 3], [0, 1, 2]])
    nobody, none = copied.one_each(np.array([0]))
    assert len(nobody) == len(none.sample) == 0
