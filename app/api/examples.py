"""Ids and names for the examples of `/docs`: with them, a reader can run the examples unchanged."""

from __future__ import annotations

from app.api.guard.callers import is_open
from app.services.curation import duplicates
from app.services.library.fitted_models import KINDS_WITH_SIGNATURES, KINDS_WITH_UNKNOWN
from app.services.library.library import Library
from app.store import collections, evaluations, models, saved_searches, studies
from app.store.clips import listing as clip_listing
from app.store.database.engine import Tx
from app.store.jobs import repository as jobs
from app.store.jobs.record import JobKind
from app.store.webhooks import repository as webhooks


def example_values(library: Library | None) -> dict[str, str]:
    """Return values of this library by placeholder; a placeholder without a value is left out.

    The result is empty if calls need a key: everyone may read the description, but not the ids.
    """
    if library is None:
        return {}
    with library.store.read() as tx:
        if not is_open(library, tx):
            return {}
        found = {**_of_clips(tx), **_of_others(tx), "API_KEY": ""}
    return {placeholder: value for placeholder, value in found.items() if value is not None}


def _of_clips(tx: Tx) -> dict[str, str | None]:
    labeled = clip_listing.newest_ready(tx, is_labeled=True)
    chosen = labeled or clip_listing.newest_ready(tx)
    audible = clip_listing.newest_ready(tx, is_audible=True)
    return {
        "CLIP_ID": None if chosen is None else chosen.id,
        "AUDIO_CLIP_ID": None if audible is None else audible.id,
        "PERSON": None if labeled is None else labeled.person,
        "TASK": None if labeled is None else labeled.task,
    }


def _of_others(tx: Tx) -> dict[str, str | None]:
    # The newest fit cannot be deleted, so a fit would be a bad example.
    analysis = jobs.list_jobs(tx, kind=JobKind.INGEST, limit=1).items
    pairs = studies.list_pairs(tx, limit=1).items
    registered = webhooks.list_all(tx)
    collected = collections.list_page(tx, limit=1).items
    saved = saved_searches.list_page(tx, limit=1).items
    kept = evaluations.list_page(tx, limit=1).items
    fitted = models.list_current(tx)
    recognizer = [one for one in fitted if one.kind in KINDS_WITH_UNKNOWN]
    multilinear = [one for one in fitted if one.kind in KINDS_WITH_SIGNATURES]
    return {
        "GROUP_ID": duplicates.example_id(tx),
        "JOB_ID": analysis[0].id if analysis else None,
        "PAIR_ID": pairs[0].id if pairs else None,
        "EVALUATION_ID": kept[0].id if kept else None,
        "COLLECTION_ID": collected[0].id if collected else None,
        "ITEM_ID": _first_item(tx, collected[0].id) if collected else None,
        "SEARCH_ID": saved[0].id if saved else None,
        "WEBHOOK_ID": registered[0].id if registered else None,
        "MODEL_ID": recognizer[0].id if recognizer else None,
        "SIGNATURE_MODEL_ID": multilinear[0].id if multilinear else None,
    }


def _first_item(tx: Tx, collection_id: str) -> str | None:
    items = collections.items_page(tx, collection_id, limit=1).items
    return items[0].id if items else None
