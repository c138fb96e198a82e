"""The documented table of all settings."""

from __future__ import annotations

from dataclasses import dataclass

from app.config.settings import CONFIG_FILE_DEFAULT, CONFIG_FILE_ENV, ENV_PREFIX, Settings


@dataclass(frozen=True, slots=True)
class SettingRow:
    """One line of the documented table of settings."""

    env: str
    default: str
    description: str


def settings_table() -> tuple[SettingRow, ...]:
    """Every setting, in the order of the class, with its default as a user would type it."""
    rows = [
        SettingRow(ENV_PREFIX + name.upper(), _as_typed(field.default), field.description or "")
        for name, field in Settings.model_fields.items()
    ]
    rows.append(
        SettingRow(CONFIG_FILE_ENV, CONFIG_FILE_DEFAULT, "TOML file with these settings by name.")
    )
    return tuple(rows)


def _as_typed(default: object) -> str:
    if default is None:
        return ""
    if isinstance(default, bool):
        return str(default).lower()
    if isinstance(default, tuple):
        return ",".join(default)
    return str(default)
