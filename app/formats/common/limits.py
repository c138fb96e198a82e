"""The limits of all readers."""

from __future__ import annotations

MAX_JOINTS = 2000
"""The most joints of a skeleton. A body with hands and face has fewer."""
