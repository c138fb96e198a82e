"""Words for a clip, as annotators would choose them: the same idea, not always the same word."""

from __future__ import annotations

from zlib import crc32

SURE: dict[str, tuple[tuple[str, ...], ...]] = {
    "walk": (("walk", "stride"), ("walk", "forward"), ("walk", "step")),
    "run": (("run", "forward"), ("run", "jog"), ("run", "fast")),
    "jump": (("jump", "up"), ("jump", "hop"), ("jump", "leap")),
    "wave": (("wave", "greet"), ("wave", "hello"), ("wave", "greet", "stand")),
    "kick": (("kick", "leg"), ("kick", "fight"), ("kick", "leg", "stand")),
    "punch": (("punch", "fight"), ("punch", "hit"), ("punch", "box", "arm")),
    "bow": (("bow", "greet"), ("bow", "bend"), ("bow", "bend", "stand")),
    "dance": (("dance", "rhythm"), ("dance", "step"), ("dance", "music")),
}
"""For each task, what one annotator or another writes."""
HANDED: dict[str, str] = {"wave": "hand", "kick": "leg", "punch": "hand"}
"""Tasks with a side, and the limb that has it."""


def words_for(task: str, actor: str, take: int, left_handed: bool) -> tuple[str, ...]:
    """Two to four words for a take, the same at every call."""
    choices = SURE[task]
    words = choices[crc32(f"{actor}/{task}/{take}/words".encode()) % len(choices)]
    if task in HANDED:
        side = "left" if left_handed else "right"
        words = (*words, f"{side}_{HANDED[task]}")
    return words
