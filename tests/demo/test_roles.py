"""The roles of the joints are found from the shape of the skeleton, without the names."""

from __future__ import annotations

import random

import pytest

from app.demo import demo_clips
from app.demo.actors import ACTORS
from app.formats.read import read_recording
from app.motion.roles.roles import find_roles


@pytest.mark.parametrize("actor", [actor.name for actor in ACTORS])
def test_removing_the_names_changes_no_role(actor: str) -> None:
    (clip,) = demo_clips(actors=[actor], tasks=["walk"], takes=1)
    recording = read_recording(clip.content)
    skeleton, positions = recording.skeleton, recording.positions
    by_name = find_roles(skeleton.names, skeleton.parents, positions)
    plain = [f"j{index}" for index in range(len(skeleton))]
    random.Random(actor).shuffle(plain)
    assert find_roles(plain, skeleton.parents, positions) == by_name
