"""A folder of dances with a manifest that gives their keyposes."""

from __future__ import annotations

from pathlib import Path

from app.demo import DemoClip
from app.demo.dances import dance

TEMPI = (80.0, 110.0, 95.0)


def write_dances(folder: Path, *, seed: int = 70, seconds: float = 10.0) -> list[DemoClip]:
    """Write a dance for each of TEMPI, dance0.bvh and so on, and `unnamed.bvh` without keyposes.

    Returns the dances with keyposes. seconds: their length.
    """
    folder.mkdir(parents=True, exist_ok=True)
    made = [dance(seed + i, bpm=bpm, seconds=seconds) for i, bpm in enumerate(TEMPI)]
    rows = ["path,task,keyposes"]
    for number, clip in enumerate(made):
        (folder / f"dance{number}.bvh").write_bytes(clip.content)
        times = " ".join(f"{time:.3f}" for time in clip.keyposes)
        rows.append(f"dance{number}.bvh,dance,{times}")
    (folder / "unnamed.bvh").write_bytes(dance(seed + 99, bpm=100.0, seconds=5.0).content)
    rows.append("unnamed.bvh,dance,")
    (folder / "manifest.csv").write_text("\n".join(rows) + "\n")
    return made
