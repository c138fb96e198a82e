"""The motion that a clip's motion symbol generates (Takano, fig. 6)."""

from __future__ import annotations

from dataclasses import dataclass

from app.analysis.symbols.playback import SymbolMotion
from app.analysis.symbols.playback import symbol_motion as generate
from app.analysis.symbols.symbol import SYMBOL_ARRAYS, symbol_from_arrays
from app.motion.frame.body_frame import body_track
from app.motion.roles.joint_roles import SUN_PARENTS, SUN_ROLES
from app.services.library.library import Library
from app.services.library.ready_clips import ready_clip
from app.services.library.stored_motion import load_motion
from app.services.views.views import MotionView
from app.store.clips import arrays


@dataclass(frozen=True, slots=True)
class SymbolMotionView:
    """states: number of states K of the symbol; generated: the trajectories of the channels, and
    the motion; motion: the motion to draw, with 13 joint roles."""

    states: int
    generated: SymbolMotion
    motion: MotionView


def symbol_motion(lib: Library, clip_id: str) -> SymbolMotionView:
    """The mean trajectory of a clip's symbol. Raises ClipNotFound, ClipNotReady."""
    track = body_track(load_motion(lib, ready_clip(lib, clip_id)))
    with lib.store.read() as tx:
        stored = {name: arrays.get_one(tx, clip_id, name) for name in SYMBOL_ARRAYS}
    symbol = symbol_from_arrays(stored)
    found = generate(symbol, track)
    names = tuple(role.value for role in SUN_ROLES)
    motion = MotionView(found.rate, names, SUN_PARENTS, found.positions)
    return SymbolMotionView(symbol.states, found, motion)
