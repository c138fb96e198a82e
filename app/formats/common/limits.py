"""The limits of all readers."""

from __future__ import annotations

MAX_JOINTS = 2000
"""More joints than any body, hands and face together."""
