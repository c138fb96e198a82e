"""The tasks of the demo actors by name. Each function performs one take."""

from __future__ import annotations

from collections.abc import Callable

from app.demo.performance import Performance
from app.demo.take import Take
from app.demo.tasks.dance import dance
from app.demo.tasks.gait import run, walk
from app.demo.tasks.gestures import bow, wave
from app.demo.tasks.jump import jump
from app.demo.tasks.kick import kick
from app.demo.tasks.punch import punch

TASKS: dict[str, Callable[[Take], Performance]] = {
    "walk": walk,
    "run": run,
    "jump": jump,
    "wave": wave,
    "kick": kick,
    "punch": punch,
    "bow": bow,
    "dance": dance,
}
"""The function of each task, by its name."""
