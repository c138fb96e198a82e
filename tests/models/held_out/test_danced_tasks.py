from __future__ import annotations

import numpy as np

from app.analysis.segments.danced_cycles import DancedCycles
from app.models.held_out.danced_tasks import arrange


def _steps(order: str, seed: int = 0) -> np.ndarray:
    """Segments, one a letter; the same letter is nearly the same segment."""
    rng = np.random.default_rng(seed)
    steps = {letter: np.random.default_rng(ord(letter)).normal(size=(4, 13, 3)) for letter in order}
    return np.stack([steps[letter] + 0.01 * rng.normal(size=(4, 13, 3)) for letter in order])


def test_steps_are_tasks_and_cycles_are_counted_by_person() -> None:
    clips = [
        DancedCycles(_steps("ababab"), 2),
        DancedCycles(_steps("abab", 1), 2),
        DancedCycles(_steps("c"), 1),
        DancedCycles(_steps("abab", 2), 2),
    ]
    danced = arrange(clips, ["ada", "ada", "ada", "bo"], ["salsa", "salsa", "bow", "salsa"])
    cells = sorted(zip(danced.persons, danced.tasks, danced.cycle.tolist(), strict=True))
    assert cells[0] == ("ada", "bow", 0)
    assert [c for c in cells if c[:2] == ("ada", "salsa 2")] == [
        ("ada", "salsa 2", k) for k in range(5)
    ]
    assert len([c for c in cells if c[0] == "bo"]) == 4


def test_cycles_are_shifted_to_the_same_start() -> None:
    clips = [DancedCycles(_steps("abcabc"), 3), DancedCycles(_steps("cabcabc", 1), 3)]
    danced = arrange(clips, ["ada", "bo"], ["salsa", "salsa"])
    for step in ("salsa 1", "salsa 2", "salsa 3"):
        of_step = danced.part(np.array([task == step for task in danced.tasks]))
        assert set(of_step.persons) == {"ada", "bo"}
        assert np.abs(of_step.poses - of_step.poses[0]).max() < 0.2


def test_other_rhythms_and_unlabeled_clips_are_left_out() -> None:
    clips = [DancedCycles(_steps("abab"), 2)] * 2 + [DancedCycles(_steps("abc"), 3)] * 2
    danced = arrange(clips, ["ada", "bo", "cy", None], ["salsa", "salsa", "salsa", "salsa"])
    assert set(danced.persons) == {"ada", "bo"}
    assert len(arrange(clips, [None] * 4, ["salsa"] * 4)) == 0
