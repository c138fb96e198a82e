"""A file of the demo library with its labels, beats and keyposes."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class DemoClip:
    """One motion file. All times are in seconds from its first frame.

    path: relative, with forward slashes. content: BVH, or NPZ if the joints have noise. words: two
    to four. frame_rate: Hz. Only dances have the others: keyposes: the time of each keypose.
    holds: start and end of the rest at each keypose. beats: those of the music. audio: the WAV
    file of the music, empty without music; audio_path: its path. audio_offset: the time of the
    motion at which the music begins; it is negative if the music begins first.
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
