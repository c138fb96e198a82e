"""What is made of takes of two sides, of other times, and of takes that do not agree."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.descriptors.motion_sample import SAMPLES
from app.analysis.descriptors.motion_shape import CHANNELS, SHAPE_LENGTH, mirrored
from app.models.synthesis.agreement import MIN_AGREEMENT
from app.models.synthesis.model import Synthesis, fit_synthesis, mean_of_takes
from app.models.synthesis.prediction import predict
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray

HANDS = {role: SUN_ROLES.index(role) for role in (JointRole.LEFT_HAND, JointRole.RIGHT_HAND)}
LEFT, RIGHT = HANDS.values()


def reach(hand: int, *, at: float = 16.0, far: float = 1.0, bent: float = 0.0) -> FloatArray:
    """(1378,) one hand goes forward and back around a moment; bent: the head before the hips."""
    moments = np.zeros((SAMPLES, CHANNELS))
    moments[:, 3 * hand + 2] = far * np.exp(-0.5 * ((np.arange(SAMPLES) - at) / 2.0) ** 2)
    moments[:, 3 * SUN_ROLES.index(JointRole.HEAD) + 2] = bent
    return np.concatenate([moments.ravel(), [np.log(3.0), 0.0]])


def hand(shape: FloatArray, which: int) -> FloatArray:
    """(32,) how far forward a hand is."""
    return np.asarray(shape[:-2].reshape(SAMPLES, CHANNELS)[:, 3 * which + 2])


def nod(bent: float, at: float = 16.0) -> FloatArray:
    """(1378,) the head goes down and up: a task without a side."""
    shape = reach(LEFT, far=0.0, bent=bent)
    moments = shape[:-2].reshape(SAMPLES, CHANNELS)
    moments[:, 3 * SUN_ROLES.index(JointRole.HEAD) + 1] = -0.5 * np.exp(
        -0.5 * ((np.arange(SAMPLES) - at) / 3.0) ** 2
    )
    return shape


def dance(seed: int) -> FloatArray:
    """(1378,) a smooth motion of all joints, another one for each seed."""
    moments = np.random.default_rng(seed).normal(size=(6, CHANNELS))
    times = np.linspace(0, 5, SAMPLES)
    smooth = np.stack([np.interp(times, np.arange(6), channel) for channel in moments.T], axis=1)
    return np.concatenate([0.3 * smooth.ravel(), [np.log(8.0), 0.0]])


def fitted(cells: dict[tuple[str, str], list[FloatArray]]) -> Synthesis:
    rows = [(shape, *cell) for cell, shapes in cells.items() for shape in shapes]
    return fit_synthesis(np.stack([row[0] for row in rows]), *list(zip(*rows, strict=True))[1:])


def of_two_sides(asked: int) -> Synthesis:
    """Three right-handers and a left-hander punch and point; "x", of a hand `asked`, points."""
    cells = {}
    for name, side in (("a", RIGHT), ("b", RIGHT), ("c", RIGHT), ("d", LEFT), ("x", asked)):
        cells[name, "point"] = [reach(side, far=0.6, at=14)]
        cells[name, "nod"] = [nod(0.1)]
        if name != "x":
            cells[name, "punch"] = [reach(side, at=at) for at in (16, 16.5)]
    return fitted(cells)


@pytest.mark.parametrize(("asked", "other"), [(LEFT, RIGHT), (RIGHT, LEFT)])
def test_a_punch_is_predicted_with_the_hand_of_the_other_tasks(asked: int, other: int) -> None:
    record = of_two_sides(asked)
    made = predict(record, record.tasks_of("x"), "punch")
    assert made.follows is None
    assert hand(made.shape, asked).max() > 0.9
    assert np.abs(hand(made.shape, other)).max() < 0.1


def test_a_person_without_sides_gets_the_most_frequent_side() -> None:
    record = of_two_sides(LEFT)
    made = predict(record, {"nod": record.tasks_of("x")["nod"]}, "punch").shape
    assert hand(made, RIGHT).max() > 0.9
    assert np.abs(hand(made, LEFT)).max() < 0.1


def test_takes_of_both_hands_of_one_person_are_not_averaged() -> None:
    takes = np.stack([reach(RIGHT), reach(LEFT), reach(RIGHT, at=16.5)])
    mean = mean_of_takes(takes)
    assert hand(mean, RIGHT).max() > 0.9
    assert np.abs(hand(mean, LEFT)).max() < 0.01


def test_takes_of_both_hands_at_different_times_are_separated() -> None:
    takes = np.stack([reach(RIGHT, at=12), reach(LEFT, at=17), reach(RIGHT, at=16)])
    mean = mean_of_takes(takes)
    assert hand(mean, RIGHT).max() > 0.9
    assert np.abs(hand(mean, LEFT)).max() < 0.01


def test_a_side_that_is_the_task_stays() -> None:
    cells = {}
    for number, name in enumerate("abcx"):
        far = 1.0 + 0.1 * number
        cells[name, "raise-left"] = [reach(LEFT, far=far)]
        cells[name, "nod"] = [nod(0.1)]
        if name != "x":
            cells[name, "raise-right"] = [reach(RIGHT, far=far)]
    record = fitted(cells)
    assert not any(record.is_two_sided(task) for task in record.tasks)
    made = predict(record, record.tasks_of("x"), "raise-right").shape
    assert hand(made, RIGHT).max() > 1.0
    assert np.abs(hand(made, LEFT)).max() < 0.1


def test_gestures_that_begin_at_other_times_keep_their_height() -> None:
    takes = np.stack([reach(RIGHT, at=at) for at in (12, 15, 18)])
    assert hand(takes.mean(axis=0), RIGHT).max() < 0.75
    assert hand(mean_of_takes(takes), RIGHT).max() > 0.9


def test_the_delay_of_a_person_is_predicted_too() -> None:
    cells = {}
    for name, late in (("a", -2), ("b", 0), ("c", 2), ("x", 4)):
        cells[name, "point"] = [reach(LEFT, at=14 + late, far=0.6)]
        cells[name, "nod"] = [nod(0.1, at=14 + late)]
        if name != "x":
            cells[name, "punch"] = [reach(RIGHT, at=14 + late)]
    record = fitted(cells)
    made = hand(predict(record, record.tasks_of("x"), "punch").shape, RIGHT)
    assert abs(int(made.argmax()) - 18) <= 1
    assert made.max() > 0.85


def of_dances() -> Synthesis:
    cells = {}
    for number, name in enumerate("abcx"):
        cells[name, "nod"] = [nod(0.1 * number)]
        cells[name, "point"] = [reach(RIGHT, bent=0.1 * number)]
        if name != "x":
            cells[name, "dance"] = [dance(10 * number + take) for take in range(3)]
    return fitted(cells)


def test_of_different_dances_one_is_followed_in_the_posture_of_the_person() -> None:
    record = of_dances()
    made = predict(record, record.tasks_of("x"), "dance")
    assert made.follows in {"a", "b", "c"}
    assert made.agreement is not None
    assert made.agreement < MIN_AGREEMENT
    moments = [
        s[:-2].reshape(SAMPLES, CHANNELS) for s in (made.shape, record.cell(made.follows, "dance"))
    ]
    away = moments[0] - moments[1]
    np.testing.assert_allclose(away[:, :39], np.tile(away[:1, :39], (SAMPLES, 1)), atol=1e-9)
    np.testing.assert_allclose(away[:, 40:], 0, atol=1e-9)  # where it goes is the dance's own
    head = 3 * SUN_ROLES.index(JointRole.HEAD) + 2
    number = "abc".index(made.follows)
    assert away[0, head] == pytest.approx((3 - number) * 0.1, abs=0.01)


def test_the_cell_of_dances_is_one_of_them() -> None:
    record = of_dances()
    cell, takes = record.cell("b", "dance"), [dance(10 + take) for take in range(3)]
    assert any(np.array_equal(cell, take) for take in takes)
    agreement = record.cell_agreement("b", "dance")
    assert agreement is not None
    assert agreement < MIN_AGREEMENT
    assert record.cell_agreement("b", "nod") is None  # a single take
    alone = predict(record, record.tasks_of("x"), "dance", exclude=("a", "c"))
    assert (alone.follows, alone.agreement) == ("b", agreement)


def test_to_one_side_or_the_other_the_library_makes_mirror_images() -> None:
    record, turned = of_two_sides(LEFT), {}
    shapes = mirrored(np.stack([record.cell("x", task) for task in ("nod", "point")]))
    turned = dict(zip(("nod", "point"), shapes, strict=True))
    left = predict(record, record.tasks_of("x"), "punch").shape
    right = predict(record, turned, "punch").shape
    assert left.shape == (SHAPE_LENGTH,)
    np.testing.assert_allclose(mirrored(right[None])[0], left, atol=0.05)
