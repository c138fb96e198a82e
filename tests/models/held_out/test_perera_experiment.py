from __future__ import annotations

import numpy as np
import pytest

from app.errors import NotEnoughLabels
from app.models.held_out.danced_tasks import DancedTasks
from app.models.held_out.perera_experiment import perera_tables
from app.models.recognition.task_model import Reading
from tests.models.danced import danced_by


def test_clear_dances_fill_all_tables() -> None:
    rows = perera_tables(danced_by(5, 4, 3))
    assert [(row.table, row.category) for row in rows] == [
        (3, "task recognition"),
        (3, "person recognition"),
        (4, "new task recognition"),
        (4, "new person recognition"),
        (5, "task recognition of known person"),
        (5, "task recognition of alien person"),
    ]
    assert rows[0].probed == 2 * 20
    assert rows[2].probed == 3 * 20
    assert all(row.accuracy > 0.9 for row in rows[:4])
    assert all(0.0 <= row.accuracy <= 1.0 and 0.8 < row.paper < 1.0 for row in rows)
    assert rows[2].known_probed == 3 * 4 * 15
    assert rows[2].balanced_accuracy > 0.6


def test_noise_is_recognized_by_chance() -> None:
    rows = perera_tables(danced_by(5, 4, 3, own=0.0, change=100.0))
    assert rows[0].accuracy < 0.5
    assert rows[1].accuracy < 0.5


def test_as_printed_a_probe_nearer_than_all_trained_cycles_is_new() -> None:
    """Known segments probed are the trained ones themselves: at no distance."""
    danced = danced_by(5, 4, 3)
    first = {p: danced.poses[i] for i, p in enumerate(_cells(danced)) if danced.cycle[i] == 0}
    poses = np.stack([first[cell] for cell in _cells(danced)])
    poses[danced.cycle == 1] = danced.poses[danced.cycle == 1]
    copies = DancedTasks(poses, danced.persons, danced.tasks, danced.cycle)
    printed = {row.category: row for row in perera_tables(copies, Reading.PRINTED)}
    least = {row.category: row for row in perera_tables(copies)}
    for name in ("new task recognition", "new person recognition"):
        assert printed[name].known_accepted < least[name].known_accepted


def _cells(danced: DancedTasks) -> list[tuple[str, str]]:
    return list(zip(danced.persons, danced.tasks, strict=True))


def test_two_cycles_are_enough_for_table_3_alone() -> None:
    rows = perera_tables(danced_by(3, 3, 2))
    assert {row.table for row in rows} == {3}


def test_two_persons_leave_nobody_out() -> None:
    rows = perera_tables(danced_by(2, 4, 3))
    assert {row.category for row in rows if row.table > 3} == {"new task recognition"}


@pytest.mark.parametrize("shape", [(1, 4, 3), (4, 1, 3), (4, 4, 1)])
def test_too_few_segments_are_refused(shape: tuple[int, int, int]) -> None:
    with pytest.raises(NotEnoughLabels, match="two"):
        perera_tables(danced_by(*shape))


def test_order_of_the_segments_does_not_matter() -> None:
    danced = danced_by(4, 4, 3, change=0.6)
    index = np.random.default_rng(1).permutation(len(danced))
    shuffled = DancedTasks(
        danced.poses[index],
        tuple(danced.persons[i] for i in index),
        tuple(danced.tasks[i] for i in index),
        danced.cycle[index],
    )
    assert perera_tables(shuffled) == perera_tables(danced)
