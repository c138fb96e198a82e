"""Analyses that hang, eat memory, die or outgrow the limits cost one failure each."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest

from app.deadline import Deadline, within
from app.demo import DemoClip
from app.errors import (
    AnalysisCrashed,
    AnalysisInterrupted,
    AnalysisTimedOut,
    ClientLeft,
    KinedexError,
    TooLarge,
    Unreadable,
)
from app.services.library.analysis_pool import AnalysisPool, AnalysisRequest, Limits
from tests.busy_processes import ENDLESS, LONG, busy_children, children_of, repeated
from tests.live import wait_until

ROOMY = Limits(seconds=60.0, memory_mb=2048, frames=100_000, joints=100)


@pytest.fixture(scope="module")
def pool() -> Iterator[AnalysisPool]:
    opened = AnalysisPool(ROOMY)
    yield opened
    opened.close()


def test_an_analysis_comes_back_with_its_arrays(
    pool: AnalysisPool, some_demo_clips: list[DemoClip], tmp_path: Path
) -> None:
    clip = some_demo_clips[0]
    found = pool.analyze(AnalysisRequest(content=clip.content))
    assert found.motion.frame_rate == clip.frame_rate
    assert "symbol_means" in found.arrays
    (tmp_path / "a.bvh").write_bytes(clip.content)
    told = AnalysisRequest(path=str(tmp_path / "a.bvh"), frame_rate=24.0, metres_per_unit=0.02)
    again = pool.analyze(told)
    assert (again.motion.frame_rate, again.motion.metres_per_unit) == (24.0, 0.02)
    assert (
        "symbol_means"
        not in pool.analyze(AnalysisRequest(content=clip.content, for_search=True)).arrays
    )


def test_the_readers_own_failure_keeps_its_place(pool: AnalysisPool) -> None:
    with pytest.raises(Unreadable) as refused:
        pool.analyze(AnalysisRequest(content=b"HIERARCHY\nROOT a\n{\n  OFSET 0 0 0\n"))
    assert "line" in refused.value.places[0].location


def test_a_joint_name_that_the_file_lacks_is_told(
    pool: AnalysisPool, some_demo_clips: list[DemoClip]
) -> None:
    with pytest.raises(KinedexError) as refused:
        pool.analyze(AnalysisRequest(content=some_demo_clips[0].content, roles={"hips": "tail"}))
    assert refused.value.places[0].location == "roles.hips"


def test_frames_and_joints_are_limited(some_demo_clips: list[DemoClip]) -> None:
    tight = AnalysisPool(Limits(60.0, 2048, frames=5, joints=100))
    with pytest.raises(TooLarge) as refused:
        tight.analyze(AnalysisRequest(content=some_demo_clips[0].content))
    assert refused.value.places[0].location == "frames"
    tight.close()


def test_an_analysis_that_nobody_waits_for_is_stopped_and_the_next_one_done(
    some_demo_clips: list[DemoClip],
) -> None:
    pool = AnalysisPool(Limits(600.0, 2048, 10_000_000, 100))
    content = repeated(some_demo_clips[0], ENDLESS)
    with within(Deadline(60.0)) as deadline:
        threading.Timer(0.3, deadline.abandon).start()
        with pytest.raises(ClientLeft):
            pool.analyze(AnalysisRequest(content=content))
    assert pool.analyze(AnalysisRequest(content=some_demo_clips[0].content)).motion.frames > 1
    pool.close()


def test_an_analysis_over_its_time_is_stopped_and_the_next_one_done(
    some_demo_clips: list[DemoClip],
) -> None:
    hasty = AnalysisPool(Limits(0.3, 2048, 10_000_000, 100))
    with pytest.raises(AnalysisTimedOut):
        hasty.analyze(AnalysisRequest(content=repeated(some_demo_clips[0], LONG)))
    with pytest.raises(Unreadable):
        hasty.analyze(AnalysisRequest(content=b"HIERARCHY\n"))
    hasty.close()


def test_an_analysis_over_its_memory_fails(some_demo_clips: list[DemoClip]) -> None:
    poor = AnalysisPool(Limits(60.0, 420, 10_000_000, 100))
    with pytest.raises(AnalysisCrashed, match=r"memory|died"):
        poor.analyze(AnalysisRequest(content=repeated(some_demo_clips[0], LONG)))
    poor.close()


def test_a_killed_child_is_replaced(pool: AnalysisPool, some_demo_clips: list[DemoClip]) -> None:
    small, large = (
        AnalysisRequest(content=some_demo_clips[0].content),
        repeated(some_demo_clips[0], LONG),
    )
    pool.analyze(small)
    _kill_children()
    working = pool.submit(AnalysisRequest(content=large))
    wait_until(lambda: busy_children(psutil.Process()), 60.0)
    _kill_children()
    with pytest.raises(AnalysisInterrupted):
        pool.outcome(working)
    assert pool.analyze(small).arrays
    _kill_children()
    assert pool.analyze(small).arrays


def _kill_children() -> None:
    for child in children_of(psutil.Process()):
        child.kill()


PARENT = """
import os, sys, time
from app.services.library.analysis_pool import AnalysisPool, AnalysisRequest, Limits
if __name__ == "__main__":
    pool = AnalysisPool(Limits(60.0, 2048, 10**9, 100))
    pool.submit(AnalysisRequest(path=sys.argv[1])).result()
    print("warm", flush=True)
    time.sleep(60)
"""


def test_children_do_not_outlive_a_killed_parent(
    some_demo_clips: list[DemoClip], tmp_path: Path
) -> None:
    (tmp_path / "parent.py").write_text(PARENT)
    (tmp_path / "a.bvh").write_bytes(some_demo_clips[0].content)
    command = [sys.executable, str(tmp_path / "parent.py"), str(tmp_path / "a.bvh")]
    environ = os.environ | {"PYTHONPATH": str(Path.cwd())}
    with subprocess.Popen(command, stdout=subprocess.PIPE, env=environ) as parent:
        assert parent.stdout is not None
        assert parent.stdout.readline() == b"warm\n"
        children = psutil.Process(parent.pid).children(recursive=True)
        assert children
        parent.send_signal(signal.SIGKILL)
    _, alive = psutil.wait_procs(children, timeout=10)
    assert not alive
