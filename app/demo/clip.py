"""A file of the demo library and what is known about it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class DemoClip:
    """One motion file; times in seconds from its first frame.

    path: relative, with forward slashes; content: BVH, or NPZ where it is noisy; words: two
    to four; frame_rate: Hz. Of dances only: keyposes, where poses are struck; holds, from
    when to when each is held; beats, of the music; audio, audio_path: WAV, what was danced
    to, empty where there is none; audio_offset: when in the motion it begins, negative if before.
    """

    path: str
    content: bytes
    person: str
    task: str
    words: tuple[str, ...]
    frame_rate: float
    keyposes: tuple[float, ...] = ()
    beats: tuple[float, ...] = ()
    holds: tuple[tuple[float, float], ...] = ()
    audio: bytes = b""
    audio_path: str = ""
    audio_offset: float | None = None
