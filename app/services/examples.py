"""What the demo library has besides clips, so that every call of the documentation shows something.

These are a pair of the study, and a webhook that is switched off.
"""

from __future__ import annotations

from app.errors import BadContent, Conflict
from app.services.library.library import Library
from app.services.views import studies
from app.services.webhooks import registry
from app.store.clips import listing as clip_listing
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipState

RECEIVER = "http://localhost:9/"
"""Address of the webhook: the discard service, which hardly any machine runs."""
TASK = "dance"
"""A dance has enough keyposes for a pair."""
TRIED = 20
"""Clips that are tried until one has enough keyposes."""


def add_examples(lib: Library) -> None:
    """Add a pair and a webhook if the library has none. Calling it again changes nothing."""
    if not registry.list_webhooks(lib):
        registry.create(lib, RECEIVER, is_enabled=False)
    _add_pair(lib)


def _add_pair(lib: Library) -> None:
    if studies.list_pairs(lib, limit=1).items:
        return
    with lib.store.read() as tx:
        dances = ClipFilter(state=(ClipState.READY,), task=(TASK,))
        any_clip = ClipFilter(state=(ClipState.READY,))
        found = [*clip_listing.list_clips(tx, dances, limit=TRIED).items]
        found += clip_listing.list_clips(tx, any_clip, limit=TRIED).items
    for clip in found:
        try:
            studies.draw_pair(lib, clip.id)
        except (BadContent, Conflict):
            continue
        return
