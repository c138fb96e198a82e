"""The limits of a requested frame rate, and of the work of one call."""

from __future__ import annotations

from dataclasses import replace

import pytest

from app.errors import BadField
from app.services.library.library import Library
from app.services.views import frame_rates
from app.services.views.frame_rates import requested_rate
from app.store.clips.record import ClipRecord
from tests.libraries import FindClip


@pytest.fixture
def clip(ready_library: Library, clip_of: FindClip) -> ClipRecord:
    """Ten minutes at 120 Hz."""
    found = clip_of("ada", "walk")
    return replace(found, frames=72_000, frame_rate=120.0, duration=600.0, joints=60)


def rate(lib: Library, clip: ClipRecord, fps: float | None) -> float:
    return requested_rate(lib, clip, fps, source=120.0, joints=60)


@pytest.mark.parametrize("fps", [1.0, 29.97, 120.0, 800.0])
def test_rates_within_the_bounds_are_accepted(
    ready_library: Library, clip: ClipRecord, fps: float
) -> None:
    assert rate(ready_library, clip, fps) == fps


def test_the_clips_own_rate_is_the_default_and_always_allowed(
    ready_library: Library, clip: ClipRecord
) -> None:
    slow = replace(clip, frame_rate=0.5)
    assert rate(ready_library, clip, None) == 120.0
    for fps in (None, 0.5):
        assert requested_rate(ready_library, slow, fps, source=0.5, joints=512) == 0.5


@pytest.mark.parametrize(
    "fps", [0.0, -1.0, 5e-324, 1e-300, 0.01, 0.999, 1000.1, 1e308, float("inf"), float("nan")]
)
def test_rates_out_of_bounds_are_refused(
    ready_library: Library, clip: ClipRecord, fps: float
) -> None:
    with pytest.raises(BadField, match="from 1 to 1000") as refused:
        rate(ready_library, clip, fps)
    assert refused.value.places[0].location == "fps"


def test_too_many_frames_are_refused(ready_library: Library, clip: ClipRecord) -> None:
    with pytest.raises(BadField, match="more than 500000 frames"):
        rate(ready_library, clip, 834.0)


@pytest.mark.parametrize("fps", [60.0, 240.0])
def test_too_many_positions_before_or_after_resampling_are_refused(
    ready_library: Library, clip: ClipRecord, fps: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    positions = 600 * 60 * max(fps, 120.0)
    monkeypatch.setattr(frame_rates, "MAX_POSITIONS", positions)
    assert rate(ready_library, clip, fps) == fps
    monkeypatch.setattr(frame_rates, "MAX_POSITIONS", positions - 1)
    with pytest.raises(BadField, match="too much work"):
        rate(ready_library, clip, fps)
