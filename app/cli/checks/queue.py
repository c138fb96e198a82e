"""Checks that are the same for a local library and for a service."""

from __future__ import annotations

from collections.abc import Sequence

from app.cli.checks.finding import Finding, fine, note, problem

MAX_WAIT_S = 120.0
"""If jobs wait longer than this and none is in work, no worker runs."""
MIN_FREE_BYTES = 2**30
"""With less free space, an import may fill the disk."""
HOPELESS_FREE_BYTES = 16 * 2**20
"""With less free space, clips cannot be stored."""
MIB = 2**20


def check_queue(jobs: Sequence[tuple[str, str, int, float]]) -> Finding:
    """Whether a worker takes the open jobs.

    jobs: kind and state, the number of such jobs, and the age of the oldest in seconds. An import
    counts as processing while it waits for its clips, so it does not show that a worker runs.
    """
    waiting = [(count, oldest) for _, state, count, oldest in jobs if state == "queued"]
    is_working = any(state == "processing" and kind != "import" for kind, state, _, _ in jobs)
    count = sum(one for one, _ in waiting)
    oldest = max((age for _, age in waiting), default=0.0)
    if not waiting:
        return fine("worker", "a worker is busy" if is_working else "no job waits for a worker")
    if is_working or oldest <= MAX_WAIT_S:
        return fine("worker", f"{count} jobs wait")
    return problem(
        "worker",
        f"{count} jobs wait, the oldest for {oldest:.0f} s, and no worker has taken one",
        "Start a worker: `kinedex serve` runs one, or `kinedex worker` alone.",
    )


def check_disk(free: int) -> Finding:
    """Whether there is space on the disk of the files; free: bytes."""
    found = f"{free / MIB:,.0f} MiB are free"
    advice = "Free space on this disk, or move the data directory to a larger one."
    if free < HOPELESS_FREE_BYTES:
        return problem("disk", found, advice)
    return note("disk", found, advice) if free < MIN_FREE_BYTES else fine("disk", found)
