"""What other machines may reach (DESIGN 12): nothing, until there is an API key."""

from __future__ import annotations

from app.config import Settings
from app.errors import ConfigurationError, Place
from app.store import keys, schema
from app.store.store import Store


def refuse_exposure_without_keys(settings: Settings) -> None:
    """Raises ConfigurationError when the service would listen off loopback with no key made.

    Raises DatabaseOutOfDate too, since it has to look into the database.
    """
    if settings.listens_on_loopback:
        return
    store = Store.open(settings.database, settings.files_dir)
    try:
        schema.prepare(settings.database)
        with store.read() as tx:
            is_guarded = keys.is_any_valid(tx)
    finally:
        store.close()
    if not is_guarded:
        raise ConfigurationError(
            f"Kinedex does not listen on {settings.host} without an API key: make one with "
            "`kinedex keys create --role admin`, or listen on 127.0.0.1.",
            places=[Place("KINEDEX_HOST", "other machines could read and change the library")],
        )
