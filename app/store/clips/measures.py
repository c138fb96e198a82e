"""The measures of clips: numbers that an analysis finds, by which lists and searches filter.

Each is a column of the table `clips` and a field of `ClipRecord` of the same name. A filter has two
fields for each, min_NAME and max_NAME.
"""

from __future__ import annotations

from app.analysis.quality.definitions import NAMES

FOUND = ("frame_rate", "joints", "travel", "speed", "energy", "tempo")
"""Hz; number of joints; meters that the hips travel over the floor; their mean speed in meters per
second; mean energy in body lengths per second; beats per minute."""

MEASURES = ("duration", *FOUND)
"""All of them; a duration is in seconds. A clip may lack any: none passes a filter by it."""

QUALITY = NAMES
"""Measures of quality and movement, which are columns of the table `clip_measures`: see
`app.analysis.quality.definitions`. Filters name them `measure.NAME.min` and `measure.NAME.max`."""

EVERY = (*MEASURES, *QUALITY)
"""All names by which lists can be sorted."""
