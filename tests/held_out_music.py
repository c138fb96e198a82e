"""Held-out styles of music, written after the weights of the beat tracker were final.

Their rhythms differ from those of the demo: triplets, off-beats, syncopation, sixteenths, bars of
five, and tones that begin slowly.
"""

from __future__ import annotations

from app.demo.dances.music import Style, every

_BACKBEAT = ((1, 1.0), (3, 1.0))
_TRIPLETS = tuple((third / 3, 0.9 if third % 3 == 0 else 0.5) for third in range(6))

HELD_OUT_STYLES: dict[str, Style] = {
    "shuffle": Style(
        4, ((0, 1.0), (2, 0.9), (3.5, 0.6)), _BACKBEAT, every(0.5), every(0.5, gain=0.8),
        ((0, 1.0), (2.5, 0.6)), swing=1 / 6,
    ),
    "one drop": Style(
        4, ((2, 1.0),), ((2, 0.8),), every(0.5, gain=0.6), ((0.5, 0.9), (1.5, 0.8), (2, 1), (3, 1)),
        every(1, start=0.5),
    ),
    "bossa": Style(
        4, ((0, 1.0), (1.5, 0.6), (2, 0.9), (3.5, 0.6)), ((0, 0.5), (1.5, 0.5), (3, 0.5)),
        every(0.5, gain=0.5), ((0, 1.0), (1.5, 0.7), (2, 1.0), (3.5, 0.7)),
        ((0, 0.8), (1.5, 0.8), (2.5, 0.8)),
    ),
    "breakbeat": Style(
        4, ((0, 1.0), (0.5, 0.8), (2.5, 0.9)), (*_BACKBEAT, (1.75, 0.4), (2.25, 0.4), (3.75, 0.4)),
        every(0.5), ((0, 1.0), (2.5, 0.8)), ((0, 0.6),),
    ),
    "sixteenths": Style(
        4, ((0, 1.0), (0.75, 0.7), (2.5, 0.9)), (*_BACKBEAT, (2.25, 0.3), (3.25, 0.3)),
        every(0.25, gain=0.7), ((0, 1.0), (0.75, 0.8), (1.5, 0.7), (2.5, 0.9), (3.25, 0.7)),
        ((0.5, 0.7), (1.75, 0.6), (3.5, 0.6)),
    ),
    "jig": Style(
        2, ((0, 1.0),), ((1, 0.6),), _TRIPLETS, ((0, 1.0), (1, 0.8)),
        ((0, 0.8), (2 / 3, 0.6), (1, 0.8), (5 / 3, 0.6)),
    ),
    "in five": Style(
        5, ((0, 1.0), (3, 0.9)), ((2, 0.8), (4, 0.8)), every(1, 5),
        ((0, 1.0), (1.5, 0.6), (3, 0.9)), ((0, 0.8), (1.5, 0.6), (3, 0.8), (4, 0.5)),
    ),
    "strings": Style(4, (), (), (), every(2, gain=0.8), every(1, gain=0.9), attack=0.15),
    "tango": Style(
        4, (), (), (), every(1), (*every(1), (3.5, 0.9))
    ),
}  # fmt: skip
