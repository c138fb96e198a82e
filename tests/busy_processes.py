"""Large motion files, and the child processes that are busy with their analysis."""

from __future__ import annotations

from contextlib import suppress

import psutil

from app.demo import DemoClip

BUSY_S = 1.5
"""CPU time after which a child is in the middle of its analysis.

The start of a child took .5 s on a loaded machine. A child that is killed before it takes its task
is replaced, which no test wants.
"""
LONG, ENDLESS = 150, 400
"""Repetitions of a demo clip whose analysis takes 3.5 and 14 s of CPU time.

This is the time in which a test must find a child to kill it. With 60 repetitions (1 s) the
analysis could end first on a machine with many processes.
"""


def repeated(clip: DemoClip, times: int) -> bytes:
    """A BVH file with the motion of the clip, `times` times."""
    head, _, frames = clip.content.partition(b"Frame Time")
    line, _, rows = frames.partition(b"\n")
    count = rows.count(b"\n") * times
    head = head[: head.rindex(b"Frames:")] + b"Frames: %d\n" % count
    return head + b"Frame Time" + line + b"\n" + rows * times


def server_of(parent: psutil.Process) -> psutil.Process | None:
    """The fork server of a process, which starts its children; None if there is none."""
    with suppress(psutil.Error):
        for child in parent.children():
            with suppress(psutil.Error):
                if "multiprocessing.forkserver" in " ".join(child.cmdline()):
                    return child
    return None


def children_of(parent: psutil.Process) -> list[psutil.Process]:
    """The analysis processes of a process."""
    with suppress(psutil.Error):
        server = server_of(parent)
        return [] if server is None else server.children()
    return []


def busy_children(parent: psutil.Process, seconds: float = BUSY_S) -> list[psutil.Process]:
    """The analysis processes that have used at least `seconds` of CPU time."""
    found = []
    for child in children_of(parent):
        with suppress(psutil.Error):
            if sum(child.cpu_times()[:2]) >= seconds:
                found.append(child)
    return found
