"""The libraries of `tests.libraries`, for the tests of this folder."""

from __future__ import annotations

from tests.libraries import clip_of, lib, mine, ready_clips, ready_library, some_demo_clips

__all__ = ["clip_of", "lib", "mine", "ready_clips", "ready_library", "some_demo_clips"]
