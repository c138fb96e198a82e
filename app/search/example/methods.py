"""The methods that compare two motions in a search by example."""

from __future__ import annotations

from enum import StrEnum


class Method(StrEnum):
    """A way to rank clips against a query clip."""

    FUSED = "fused"
    """Shortlist by motion vector, re-rank by DTW and the graph between its clips; the default."""
    VECTOR = "vector"
    """Euclidean distance of the 128-float motion vectors."""
    DTW = "dtw"
    """Dynamic time warping of the body-frame features at 10 Hz, over every clip."""
    MSV_DTW = "msv-dtw"
    """Sun 2011, equation 7: DTW of the primary vectors, twice, and of the secondary ones."""
    MSV_XCORR = "msv-xcorr"
    """Sun 2011, equation 6: 3 - D_xcorr, so that more similar motions have smaller distances."""
    METRIC_TASK = "metric-task"
    """Euclidean distance in coordinates learned from the library's tasks: the same task first."""
    METRIC_PERSON = "metric-person"
    """The same for coordinates learned from persons: the same person, or style, first."""


LEARNED = frozenset({Method.METRIC_TASK, Method.METRIC_PERSON})
"""Methods with a fitted model. Their score is the probability that the labels are the same."""
