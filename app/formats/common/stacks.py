"""Chooses one of several animations of a file: the one that a client named, or the longest."""

from __future__ import annotations

import unicodedata
from collections.abc import Sequence

import numpy as np

from app.errors import BadField
from app.kinedex_error import Place
from app.motion.skeleton.recording import Caution

MAX_NAMES_SHOWN = 100
"""The most names of stacks in a message."""


def choose_stack(names: Sequence[str], lengths: Sequence[float], name: str | None) -> int:
    """The index of the stack named `name`; without a name, of the longest stack.

    names, lengths: (stacks,). Raises BadField if no stack has the name.
    """
    if name is None:
        return int(np.argmax(lengths))
    sent_names = [_as_sent(one) for one in names]
    if _as_sent(name) not in sent_names:
        message = f"expected one of the file's stacks ({listed(names)}), found {name!r}"
        raise BadField(f"stack: {message}", places=[Place("stack", message)])
    return sent_names.index(_as_sent(name))


def stack_caution(
    names: Sequence[str], lengths: Sequence[float], chosen: int
) -> tuple[Caution, ...]:
    """A caution with the names of the stacks if the file has several.

    lengths: (stacks,) negative for a stack that does not move the body.
    """
    moving = [name for name, length in zip(names, lengths, strict=True) if length >= 0]
    if len(moving) < 2:
        return ()
    detail = (
        f"the file has {len(moving)} animations ({listed(moving)}); {names[chosen]} was read,"
        " send `stack` to choose another"
    )
    return (Caution("stack_chosen", detail),)


def listed(names: Sequence[str]) -> str:
    """The names of the stacks as one text, for a message."""
    more = f" and {len(names) - MAX_NAMES_SHOWN} more" if len(names) > MAX_NAMES_SHOWN else ""
    return ", ".join(names[:MAX_NAMES_SHOWN]) + more


def _as_sent(name: str) -> str:
    """A name in the form in which HTML forms send it: NFC, without spaces at the ends."""
    return unicodedata.normalize("NFC", name).strip()
