"""Calls: symbols. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kinedex.call import OCTETS, Call, path_of, record
from kinedex.positions import Positions, positions

if TYPE_CHECKING:
    from kinedex.types.symbols import SymbolMotion


def get_symbol_motion(clip_id: str) -> Call[SymbolMotion]:
    """The mean trajectory of the clip's motion symbol.

    It is shown as channels with their standard deviations, and as a motion of the 13 joint
    roles. `Accept: application/octet-stream` returns only the motion.
    """
    from kinedex.types.symbols import SymbolMotion

    return Call(
        "get_symbol_motion",
        "GET",
        path_of("/v1/clips/{clip_id}/symbol/motion", clip_id=clip_id),
        record(SymbolMotion),
    )


def get_symbol_motion_array(clip_id: str) -> Call[Positions]:
    """The mean trajectory of the clip's motion symbol. The answer is an array.

    It is shown as channels with their standard deviations, and as a motion of the 13 joint
    roles. `Accept: application/octet-stream` returns only the motion.
    """
    return Call(
        "get_symbol_motion",
        "GET",
        path_of("/v1/clips/{clip_id}/symbol/motion", clip_id=clip_id),
        positions,
        accept=OCTETS,
    )
