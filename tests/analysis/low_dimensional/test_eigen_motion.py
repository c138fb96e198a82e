"""Low-dimensional motion: equations 4 to 11 and their properties."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.analysis.keyposes.keyposes import find_keyposes
from app.analysis.low_dimensional.eigen_motion import (
    EigenModel,
    eigen_model,
    low_dimensional,
    reconstruction_errors,
    uniform_frames,
)
from app.motion.frame.body_frame import BodyTrack, body_track
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, standing, turned_about_y, walking
from tests.dances import dance


@pytest.fixture(scope="module")
def track() -> BodyTrack:
    made = dance(3, 100, beats=16)
    return body_track(motion_of(made.positions, made.rate))


@pytest.fixture(scope="module")
def keyposes(track: BodyTrack) -> FloatArray:
    return track.local[find_keyposes(track).frames]


def _printed(keyposes: FloatArray, poses: FloatArray, dimensions: int) -> FloatArray:
    """Equations 4 to 8 as they stand: the K x K covariance, one pose and one axis at a time."""
    rows = keyposes.reshape(len(keyposes), -1)
    mean = rows.mean(axis=0)
    q = rows - mean
    values, vectors = np.linalg.eigh(q @ q.T)
    found = []
    for pose in poses.reshape(len(poses), -1):
        drawn = mean.copy()
        for k in np.argsort(values)[::-1][:dimensions]:
            upsilon = q.T @ vectors[:, k]
            if np.linalg.norm(upsilon) > 1e-6:
                upsilon /= np.linalg.norm(upsilon)
                drawn += upsilon * (upsilon @ (pose - mean))
        found.append(drawn)
    return np.array(found).reshape(poses.shape)


@pytest.mark.parametrize("dimensions", [1, 2, 3, 7])
def test_poses_are_drawn_as_the_equations_say(
    track: BodyTrack, keyposes: FloatArray, dimensions: int
) -> None:
    model = eigen_model(keyposes)
    some = track.local[::25]
    drawn = model.poses_at(model.coordinates(some, dimensions))
    np.testing.assert_allclose(drawn, _printed(keyposes, some, dimensions), atol=1e-8)


def test_the_variance_kept_is_that_of_the_poses(keyposes: FloatArray) -> None:
    model = eigen_model(keyposes)
    kept = model.variance_kept()
    assert kept.shape == (len(keyposes),)
    assert (np.diff(kept) >= 0).all()
    assert kept[-1] == kept[-2] == pytest.approx(1)
    away = keyposes - keyposes.mean(axis=0)
    for dimensions in (1, 3, 6):
        drawn = model.poses_at(model.coordinates(keyposes, dimensions))
        left = np.square(keyposes - drawn).sum() / np.square(away).sum()
        assert kept[dimensions - 1] == pytest.approx(1 - left)


def test_all_dimensions_give_the_model_s_own_poses_back(keyposes: FloatArray) -> None:
    model = eigen_model(keyposes)
    for dimensions in (model.poses - 1, model.poses):
        drawn = model.poses_at(model.coordinates(keyposes, dimensions))
        np.testing.assert_allclose(drawn, keyposes, atol=1e-10)


def test_errors_are_what_the_drawn_motion_shows(track: BodyTrack, keyposes: FloatArray) -> None:
    model = eigen_model(keyposes)
    errors = reconstruction_errors(model, track)
    assert (np.diff(errors) <= 1e-12).all()
    for dimensions in (1, 3, model.poses):
        drawn = low_dimensional(model, track, dimensions)
        away = np.linalg.norm(drawn.positions - track.positions, axis=-1)
        assert errors[dimensions - 1] == pytest.approx(np.sqrt(np.mean(away**2)))


def test_place_heading_and_size_are_the_original_s(track: BodyTrack, keyposes: FloatArray) -> None:
    drawn = low_dimensional(eigen_model(keyposes), track, 2)
    np.testing.assert_allclose(drawn.positions[:, 4], track.origin, atol=1e-12)
    again = body_track(motion_of(drawn.positions))
    np.testing.assert_allclose(again.local[:, [7, 8]], drawn.local[:, [7, 8]], atol=0.05)
    assert drawn.frames == track.frames


def test_persons_of_any_size_and_heading_make_one_model() -> None:
    small = dance(1, 90, beats=10, noise=0.0)
    large = turned_about_y(1.3 * small.positions, 2.0) + np.array([4.0, 0.2, -3.0])
    one, other = (body_track(motion_of(p, small.rate)) for p in (small.positions, large))
    frames = find_keyposes(one).frames
    alone = eigen_model(one.local[frames])
    both = eigen_model(np.concatenate([one.local[frames], other.local[frames]]))
    assert both.poses == 2 * alone.poses
    np.testing.assert_allclose(both.eigenvalues[: len(frames)], alone.eigenvalues, atol=1e-6)
    np.testing.assert_allclose(
        reconstruction_errors(both, other)[:5],
        1.3 * reconstruction_errors(both, one)[:5],
        rtol=1e-3,
    )


def test_signs_do_not_depend_on_the_order_of_poses(keyposes: FloatArray) -> None:
    one, other = eigen_model(keyposes), eigen_model(keyposes[::-1])
    np.testing.assert_allclose(one.axes[:4], other.axes[:4], atol=1e-8)


def test_a_body_that_stands_still_has_no_axis_and_no_error() -> None:
    track = body_track(motion_of(standing(40)))
    model = eigen_model(track.local[uniform_frames(40, 5)])
    assert model.axes.shape == (0, 13, 3)
    assert model.variance_kept().tolist() == [1.0] * 5
    drawn = low_dimensional(model, track, 5)
    np.testing.assert_allclose(drawn.positions, track.positions, atol=1e-9)
    np.testing.assert_allclose(reconstruction_errors(model, track), 0, atol=1e-6)


def test_one_pose_is_a_model_of_no_change(track: BodyTrack) -> None:
    model = eigen_model(track.local[:1])
    assert model.poses == 1
    drawn = low_dimensional(model, track, 1)
    np.testing.assert_allclose(drawn.local, np.broadcast_to(track.local[0], drawn.local.shape))


def test_more_poses_than_coordinates_have_no_more_axes() -> None:
    track = body_track(motion_of(walking(10.0)))
    model = eigen_model(track.local)
    assert model.poses == track.frames > 39 >= len(model.axes)
    assert reconstruction_errors(model, track)[-1] < 1e-6
    assert model.coordinates(track.local, model.poses).shape == (track.frames, model.poses)


@pytest.mark.parametrize("dimensions", [-1, 0, 99])
def test_dimensions_beyond_the_poses_are_refused(keyposes: FloatArray, dimensions: int) -> None:
    model = eigen_model(keyposes)
    with pytest.raises(ValueError, match=f"from 1 to {len(keyposes)}, found {dimensions}"):
        model.coordinates(keyposes, dimensions)
    with pytest.raises(ValueError, match="dimensions must be"):
        model.poses_at(np.zeros((2, max(dimensions, 0))))


def test_no_pose_is_no_model() -> None:
    with pytest.raises(ValueError, match="at least one pose"):
        eigen_model(np.zeros((0, 13, 3)))


@given(st.integers(1, 500), st.data())
def test_uniform_frames_are_evenly_spaced_and_inside(frames: int, data: st.DataObject) -> None:
    count = data.draw(st.integers(1, frames))
    found = uniform_frames(frames, count)
    steps = np.diff(found)
    assert len(set(found.tolist())) == count
    assert 0 <= found[0] <= found[-1] < frames
    assert count == 1 or steps.max() - steps.min() <= 1


@pytest.mark.parametrize("count", [0, 11])
def test_uniform_frames_need_frames(count: int) -> None:
    with pytest.raises(ValueError, match=f"from 1 to 10, found {count}"):
        uniform_frames(10, count)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(2, 12))
def test_axes_are_orthonormal_and_no_other_space_is_nearer(seed: int, count: int) -> None:
    draw = np.random.default_rng(seed)
    poses = draw.normal(size=(count, 13, 3))
    model: EigenModel = eigen_model(poses)
    rows = model.axes.reshape(len(model.axes), -1)
    np.testing.assert_allclose(rows @ rows.T, np.eye(len(rows)), atol=1e-10)
    random_axis = draw.normal(size=39)
    random_axis /= np.linalg.norm(random_axis)
    away = (poses - model.mean).reshape(count, -1)
    assert np.square(away @ rows[0]).sum() >= np.square(away @ random_axis).sum() - 1e-9
