"""Reads the settings of this process, and says which of them are wrong, without their values."""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from app.config.settings import CONFIG_FILE_ENV, ENV_PREFIX, Settings
from app.config.table import settings_table
from app.errors import ConfigurationError
from app.kinedex_error import Place

OTHER_VARIABLES = frozenset({CONFIG_FILE_ENV, "KINEDEX_DATA_SET", "KINEDEX_URL", "KINEDEX_API_KEY"})
"""Variables with our prefix that are no settings. The second names the folder of the real clips
that tests read. The last two are read by the client: the service to call, and the key to send."""


def load_settings(**flags: Any) -> Settings:
    """The settings of this process. A flag with the value None counts as not given.

    Raises ConfigurationError, which names each wrong setting without its value.
    """
    given = {name: value for name, value in flags.items() if value is not None}
    named = os.environ.get(CONFIG_FILE_ENV)
    if named is not None and not Path(named).is_file():
        raise ConfigurationError(f"{CONFIG_FILE_ENV} names a file that does not exist: {named}")
    _refuse_unknown(os.environ)
    try:
        return Settings(**given)
    except ValidationError as error:
        raise _as_configuration_error(error) from None
    except ValueError as error:  # tomllib.TOMLDecodeError
        raise ConfigurationError(f"The settings file cannot be read: {error}") from None


def _refuse_unknown(environ: Iterable[str]) -> None:
    """Raises ConfigurationError for a variable with our prefix that is no setting.

    Otherwise a mistyped name would silently leave its setting at the default.
    """
    allowed = {ENV_PREFIX + name.upper() for name in Settings.model_fields} | OTHER_VARIABLES
    ours = (name for name in sorted(environ) if name.upper().startswith(ENV_PREFIX))
    places = [Place(name, _unknown_message(name)) for name in ours if name.upper() not in allowed]
    if places:
        raise _configuration_error(places)


def _unknown_message(name: str) -> str:
    names = [row.env for row in settings_table()]
    near = difflib.get_close_matches(name.upper(), names, n=1)
    return "there is no such setting" + (f"; did you mean {near[0]}?" if near else "")


def _as_configuration_error(error: ValidationError) -> ConfigurationError:
    # Without the input: it may be a secret.
    items = error.errors(include_input=False, include_url=False, include_context=False)
    places = []
    for item in items:
        name = ENV_PREFIX + ".".join(str(part) for part in item["loc"]).upper()
        is_unknown = item["type"] == "extra_forbidden"
        message = item["msg"].removeprefix("Value error, ")
        places.append(Place(name, _unknown_message(name) if is_unknown else message))
    return _configuration_error(places)


def _configuration_error(places: list[Place]) -> ConfigurationError:
    detail = "; ".join(f"{place.location}: {place.message}" for place in places)
    return ConfigurationError(f"The settings do not allow this: {detail}", places=places)
