"""The settings of an installation."""

from app.config.loading import load_settings
from app.config.settings import (
    CONFIG_FILE_ENV,
    DAY_S,
    ENV_PREFIX,
    LOOPBACK_HOSTS,
    Settings,
    sqlite_url,
)
from app.config.table import SettingRow, settings_table

__all__ = [
    "CONFIG_FILE_ENV",
    "DAY_S",
    "ENV_PREFIX",
    "LOOPBACK_HOSTS",
    "SettingRow",
    "Settings",
    "load_settings",
    "settings_table",
    "sqlite_url",
]
