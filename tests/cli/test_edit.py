"""`kinedex edit`."""

from __future__ import annotations

import pytest

from tests.cli.conftest import Kinedex

USAGE = 2


def test_a_clip_is_edited_by_steps(kinedex: Kinedex) -> None:
    (clip,) = kinedex("clips", "list", "--task", "walk", "--limit", "1", "--json").json()["items"]
    steps = ("cut=0.1:1.1", "mirror", "resample=25", "in-place", "loop=0.4:0.7")
    made = kinedex("edit", clip["id"], *steps, "--name", "many steps", "--json").json()
    assert made["clip"]["name"] == "many steps"
    kinds = [step["kind"] for step in made["clip"]["origin"]["steps"]]
    assert kinds == ["cut", "mirror", "resample", "in_place", "loop"]
    shown = kinedex("clips", "show", made["clip"]["id"]).out
    assert f"{clip['id']}: cut, mirror" in " ".join(shown.split())
    assert "many steps" in kinedex("edit", clip["id"], *steps).out
    assert kinedex("clips", "delete", made["clip"]["id"], "--yes").code == 0


@pytest.mark.parametrize("step", ["cut=a", "mirror=3", "resample", "shrink", "loop=x:y"])
def test_a_wrong_step_is_explained(kinedex: Kinedex, step: str) -> None:
    ended = kinedex("edit", "clip_any", step)
    assert ended.code == USAGE
    assert "a step is" in " ".join(ended.err.split())
