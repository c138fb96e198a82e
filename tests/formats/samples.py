"""Small BVH files for tests, built from parts."""

from __future__ import annotations

HIERARCHY = """HIERARCHY
ROOT Hips
{
  OFFSET 0.0 0.0 0.0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Spine
  {
    OFFSET 0.0 10.0 0.0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0.0 5.0 0.0
    }
  }
}
"""
ROWS = ("1 2 3 90 0 0 0 0 0", "4 5 6 0 0 0 0 0 90")
SPINE = ((-9.0, 2.0, 3.0), (4.0, 15.0, 6.0))
"""The positions of the spine in the two frames."""


def bvh(
    hierarchy: str = HIERARCHY,
    rows: tuple[str, ...] = ROWS,
    *,
    frames: str | None = None,
    frame_time: str = "0.0333333",
) -> bytes:
    """A BVH file; `frames` is the declared number, by default the true one."""
    declared = str(len(rows)) if frames is None else frames
    head = f"MOTION\nFrames: {declared}\nFrame Time: {frame_time}\n"
    return (hierarchy + head + "".join(row + "\n" for row in rows)).encode()
