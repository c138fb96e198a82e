"""The error for a skeleton without the joints that an analysis needs."""

from __future__ import annotations

from collections.abc import Sequence

from app.errors import NotHuman
from app.kinedex_error import Place
from app.motion.roles.joint_roles import JointRole

MAX_NAMES = 80
"""The most names of joints in the message."""
MAX_NAME = 40
"""The most characters of a name in the message."""


def no_joints_for(roles: Sequence[JointRole], names: Sequence[str]) -> NotHuman:
    """A NotHuman that lists the names in the file, so that a client can send `roles`.

    names: (joints,).
    """
    missing = ", ".join(roles)
    shown = ", ".join(name[:MAX_NAME] for name in names[:MAX_NAMES])
    more = f" and {len(names) - MAX_NAMES} more" if len(names) > MAX_NAMES else ""
    places = [Place(f"roles.{role}", "expected a joint, found none") for role in roles]
    return NotHuman(
        f"The skeleton has no joint for: {missing}. Send `roles` to name the joints. The file has:"
        f" {shown}{more}",
        places=[*places, Place("joints", f"found {len(names)}: {shown}{more}")],
    )
