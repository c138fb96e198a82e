"""An analysis that hangs, crashes or exceeds a limit fails alone; the next one succeeds."""

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
    TooLarge,
    Unreadable,
)
from app.kinedex_error import KinedexError
from app.services.library.analysis_pool import AnalysisPool, AnalysisRequest, Limits
from tests.busy_processes import ENDLESS, LONG, busy_children, children_of, repeated
from tests.live import NET_S, wait_until

ROOMY = Limits(seconds=60.0, memory_mb=2048, frames=100_000, joints=100)


@pytest.fixture(scope="module")
def pool() -> Iterator[AnalysisPool]:
    opened = AnalysisPool(ROOMY)
    yield opened
    opened.close()


def test_an_analysis_returns_motion_and_arrays(
    pool: AnalysisPool, some_demo_clips: list[DemoClip], tmp_path: Path
) -> None:
    clip = some_demo_clips[0]
    analysis = pool.analyze(AnalysisRequest(content=clip.content))
    assert analysis.motion.frame_rate == clip.frame_rate
    assert "symbol_means" in analysis.arrays
    (tmp_path / "a.bvh").write_bytes(clip.content)
    request = AnalysisRequest(path=str(tmp_path / "a.bvh"), frame_rate=24.0, metres_per_unit=0.02)
    with_hints = pool.analyze(request)
    assert (with_hints.motion.frame_rate, with_hints.motion.metres_per_unit) == (24.0, 0.02)
    assert (
        "symbol_means"
        not in pool.analyze(AnalysisRequest(content=clip.content, for_search=True)).arrays
    )


def test_a_readers_error_keeps_the_line_number(pool: AnalysisPool) -> None:
    with pytest.raises(Unreadable) as refused:
        pool.analyze(AnalysisRequest(content=b"HIERARCHY\nROOT a\n{\n  OFSET 0 0 0\n"))
    assert "line" in refused.value.places[0].location


def test_a_hint_with_an_unknown_joint_is_refused_by_its_role(
    pool: AnalysisPool, some_demo_clips: list[DemoClip]
) -> None:
    with pytest.raises(KinedexError) as refused:
        pool.analyze(AnalysisRequest(content=some_demo_clips[0].content, roles={"hips": "tail"}))
    assert refused.value.places[0].location == "roles.hips"


def test_frames_and_joints_are_limited(some_demo_clips: list[DemoClip]) -> None:
    pool = AnalysisPool(Limits(60.0, 2048, frames=5, joints=100))
    with pytest.raises(TooLarge) as refused:
        pool.analyze(AnalysisRequest(content=some_demo_clips[0].content))
    assert refused.value.places[0].location == "frames"
    pool.close()


def test_after_the_client_left_the_analysis_stops_and_the_next_one_succeeds(
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


def test_an_analysis_beyond_its_time_limit_stops_and_the_next_one_runs(
    some_demo_clips: list[DemoClip],
) -> None:
    pool = AnalysisPool(Limits(0.3, 2048, 10_000_000, 100))
    with pytest.raises(AnalysisTimedOut):
        pool.analyze(AnalysisRequest(content=repeated(some_demo_clips[0], LONG)))
    with pytest.raises(Unreadable):
        pool.analyze(AnalysisRequest(content=b"HIERARCHY\n"))
    pool.close()


def test_an_analysis_beyond_its_memory_limit_fails(some_demo_clips: list[DemoClip]) -> None:
    pool = AnalysisPool(Limits(60.0, 420, 10_000_000, 100))
    with pytest.raises(AnalysisCrashed, match=r"memory|died"):
        pool.analyze(AnalysisRequest(content=repeated(some_demo_clips[0], LONG)))
    pool.close()


def test_a_killed_child_is_replaced(pool: AnalysisPool, some_demo_clips: list[DemoClip]) -> None:
    small, large = (
        AnalysisRequest(content=some_demo_clips[0].content),
        repeated(some_demo_clips[0], LONG),
    )
    pool.analyze(small)
    _kill_children()
    working = pool.submit(AnalysisRequest(content=large))
    wait_until(lambda: busy_children(psutil.Process()), NET_S)
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
from app.services.library.analysis_pool import AnalysisPool, AnalysisRequest, Limits, _prepare
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
    _, alive = psutil.wait_procs(children, timeout=300)
    assert not alive
