"""Controls and posing: mirror images, arcs, and ankles at their positions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.demo.actors import ACTORS, Actor
from app.demo.controls import Controls, along_arc, mirrored, standing_controls
from app.demo.posing import ankle_position, local_rotations
from app.demo.rig import FOOT, SIDES, Rig, build_rig, skeleton_of
from app.motion.skeleton.kinematics import forward_kinematics, local_translations

FRAMES = 20


def positions(controls: Controls, rig: Rig, actor: Actor) -> np.ndarray:
    skeleton = skeleton_of(rig, actor.naming, 1.0)
    moved = local_translations(skeleton, controls.root)
    return forward_kinematics(skeleton, local_rotations(controls, rig), moved)


def striding(actor: Actor, rig: Rig) -> Controls:
    """An asymmetric motion: the body moves and turns, one foot is forward and up."""
    still = standing_controls(actor, rig, FRAMES)
    ramp = np.linspace(0.0, 1.0, FRAMES)
    ahead = np.outer(ramp, [0.05, -0.02, 0.3])
    left = replace(
        still.feet[0],
        position=still.feet[0].position + np.outer(ramp, [0.0, 0.1, 0.5]),
        pitch=-ramp,
    )
    return replace(
        still,
        root=still.root + ahead - [0.0, 0.05, 0.0],
        spine=replace(still.spine, yaw=still.spine.yaw + 0.3 * ramp),
        feet=(left, still.feet[1]),
    )


@pytest.mark.parametrize("actor", ACTORS, ids=lambda actor: actor.name)
def test_ankles_are_at_the_positions_of_the_controls(actor: Actor) -> None:
    rig = build_rig(actor)
    controls = striding(actor, rig)
    world = positions(controls, rig, actor)
    for side in SIDES:
        expected = ankle_position(controls.feet[side], rig)
        np.testing.assert_allclose(world[:, FOOT[side]], expected, atol=1e-6)


@pytest.mark.parametrize("actor", ACTORS[:2], ids=lambda actor: actor.name)
def test_a_mirrored_performance_is_the_mirror_image(actor: Actor) -> None:
    rig = build_rig(actor)
    controls = striding(actor, rig)
    image = positions(mirrored(controls), rig, actor) * [-1.0, 1.0, 1.0]
    world = positions(controls, rig, actor)
    swapped = [*range(6), *range(10, 14), *range(6, 10), *range(18, 22), *range(14, 18)]
    np.testing.assert_allclose(image[:, swapped], world, atol=1e-9)


@pytest.mark.parametrize("curvature", [0.0, 0.08, -0.3])
def test_along_an_arc_a_standing_foot_stays_and_distances_do_not_change(curvature: float) -> None:
    rig = build_rig(ACTORS[0])
    controls = striding(ACTORS[0], rig)
    controls = replace(controls, root=controls.root * [0.0, 1.0, 1.0])
    arc = along_arc(controls, 0.4, curvature)
    assert np.max(np.ptp(arc.feet[1].position, axis=0)) < 1e-12

    def distance(root: np.ndarray) -> float:
        return float(np.linalg.norm(np.diff(root, axis=0), axis=1).sum())

    assert distance(arc.root) == pytest.approx(distance(controls.root), rel=1e-3)
    heading = np.arctan2(*(arc.root[-1] - arc.root[-2])[[0, 2]])
    assert heading == pytest.approx(arc.pelvis.yaw[-1], abs=0.01)
