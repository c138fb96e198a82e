"""One take of each actor and task, generated and read once for all tests of this folder."""

from __future__ import annotations

import pytest

from app.demo import DemoClip, demo_clips
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.motion.motion import Motion


@pytest.fixture(scope="session")
def clips() -> dict[tuple[str, str], DemoClip]:
    """The first take by (person, task)."""
    return {(clip.person, clip.task): clip for clip in demo_clips(takes=1)}


@pytest.fixture(scope="session")
def motions(clips: dict[tuple[str, str], DemoClip]) -> dict[tuple[str, str], Motion]:
    """The same clips as canonical motion."""
    return {key: canonicalize(read_recording(clip.content)) for key, clip in clips.items()}
