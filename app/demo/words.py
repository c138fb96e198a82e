"""Words of a clip. As with real annotators, takes of a task do not all have the same words."""

from __future__ import annotations

from zlib import crc32

WORD_CHOICES: dict[str, tuple[tuple[str, ...], ...]] = {
    "walk": (("walk", "stride"), ("walk", "forward"), ("walk", "step")),
    "run": (("run", "forward"), ("run", "jog"), ("run", "fast")),
    "jump": (("jump", "up"), ("jump", "hop"), ("jump", "leap")),
    "wave": (("wave", "greet"), ("wave", "hello"), ("wave", "greet", "stand")),
    "kick": (("kick", "leg"), ("kick", "fight"), ("kick", "leg", "stand")),
    "punch": (("punch", "fight"), ("punch", "hit"), ("punch", "box", "arm")),
    "bow": (("bow", "greet"), ("bow", "bend"), ("bow", "bend", "stand")),
    "dance": (("dance", "rhythm"), ("dance", "step"), ("dance", "music")),
}
"""The alternative word lists of each task."""
SIDED_LIMBS: dict[str, str] = {"wave": "hand", "kick": "leg", "punch": "hand"}
"""Tasks that use one side, and their limb."""


def words_for(task: str, actor: str, take: int, left_handed: bool) -> tuple[str, ...]:
    """Two to four words of a take. Every call returns the same words."""
    choices = WORD_CHOICES[task]
    words = choices[crc32(f"{actor}/{task}/{take}/words".encode()) % len(choices)]
    if task in SIDED_LIMBS:
        side = "left" if left_handed else "right"
        words = (*words, f"{side}_{SIDED_LIMBS[task]}")
    return words
