"""Reads CSV and TSV files of motion-capture programs: bytes in, Recording out.

The program is recognized by its first line: Motive begins with `Format Version`, Qualisys with
`NO_OF_FRAMES`, and Vicon Nexus with the name of a section.
"""

from __future__ import annotations

from app.formats.common.lines import with_plain_newlines
from app.formats.markers.recording import recording_of_markers
from app.formats.tables.motive import motive_layout
from app.formats.tables.nexus import nexus_layout
from app.formats.tables.qtm import qtm_layout
from app.motion.skeleton.recording import Recording


def read_csv(content: bytes) -> Recording:
    """Read a CSV file of Motive or Nexus.

    Raises Unreadable with the line, or with a marker that is hidden for too long;
    FormatNotSupported for bones in local coordinates; and TooLarge.
    """
    text = with_plain_newlines(content)
    is_motive = text.lstrip().lower().startswith((b"format version", b'"format version'))
    layout = motive_layout(text) if is_motive else nexus_layout(text)
    return recording_of_markers(layout.tracks(), "csv")


def read_tsv(content: bytes) -> Recording:
    """Read a TSV file of Qualisys. Raises the same errors as `read_csv`."""
    return recording_of_markers(qtm_layout(with_plain_newlines(content)).tracks(), "tsv")
