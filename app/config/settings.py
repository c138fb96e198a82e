"""The settings of an installation: flags, then `KINEDEX_*`, then a TOML file, then defaults.

`app.config.table` documents all of them; a test compares `docker/README.md` with it.
Secrets are `SecretStr`, so that neither a log line nor a traceback shows them.
"""

from __future__ import annotations

import ipaddress
import os
import re
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, SecretStr, ValidationInfo, field_validator
from pydantic_settings import (
    BaseSettings,
    NoDecode,
    PydanticBaseSettingsSource,
    SettingsConfigDict,
    TomlConfigSettingsSource,
)

from app.config.files import FilesSettings
from app.store.files.bucket import FilesPlace

ENV_PREFIX = "KINEDEX_"
CONFIG_FILE_ENV = "KINEDEX_CONFIG_FILE"
CONFIG_FILE_DEFAULT = "kinedex.toml"
MIN_HEARTBEATS_PER_LEASE = 2.0
"""With fewer, one late heartbeat would give a job to another worker."""
LOOPBACK_HOSTS = frozenset({"127.0.0.1", "::1", "localhost"})
MIB = 1024 * 1024
_ESCAPED_IN_URLS = str.maketrans({"%": "%25", "?": "%3F"})
DAY_S = 24 * 3600.0
MAX_RETENTION_DAYS = 36_500
"""A century. Python can still compute a date a century ago."""
_ORIGIN = re.compile(r"https?://[^/?#,\s*]+", re.ASCII)
_ROOT_PATH = re.compile(r"(?:/[A-Za-z0-9._~-]+)*", re.ASCII)
_Listed = Annotated[tuple[str, ...], NoDecode]
"""A list that the environment and flags write with commas."""


class Settings(FilesSettings):
    """All settings; each field's description is its documentation."""

    model_config = SettingsConfigDict(
        env_prefix=ENV_PREFIX, extra="forbid", frozen=True, validate_default=True
    )

    data_dir: Path = Field(
        Path("data"), description="Directory of the database, the uploaded files and the demo."
    )
    database_url: SecretStr | None = Field(
        None,
        description="URL of a PostgreSQL database, as in `postgresql://kinedex@db/kinedex`; unset: "
        "SQLite in the data directory.",
    )
    database_connections: int = Field(
        40,
        ge=2,
        le=1000,
        description="Most connections of one process to a PostgreSQL server. The server must allow "
        "this number for each API process, and about four for each worker.",
    )
    database_statement_timeout_s: float = Field(
        300.0,
        ge=0,
        le=DAY_S,
        description="Seconds that PostgreSQL may take for one statement; 0: any time.",
    )
    host: str = Field(
        "127.0.0.1",
        description="Address to listen on; if it is not loopback, an API key must exist.",
    )
    port: int = Field(8000, ge=0, le=65535, description="Port to listen on; 0 takes a free one.")
    processes: int = Field(
        1,
        ge=1,
        le=64,
        description="Processes of the API, which share the port; about one for each core. Each has "
        "its own copy of the indexes in memory.",
    )
    require_keys: bool = Field(
        False, description="Require an API key on loopback too (elsewhere it is always required)."
    )
    root_path: str = Field(
        "",
        description="Path below which a reverse proxy shows Kinedex, as in `/kinedex`. The proxy "
        "removes it from the path of each request.",
    )
    trusted_proxies: _Listed = Field(
        (),
        description="Addresses or networks of reverse proxies, separated by commas. Only "
        "their `X-Forwarded-For` and `X-Forwarded-Proto` are believed.",
    )
    allowed_licenses: _Listed = Field(
        (),
        description="Licenses with commas between them: searches find and exports give out no clip "
        "with another license or without one; empty allows all.",
    )
    cors_origins: _Listed = Field(
        (),
        description="Origins of web pages that may call the API from a browser, separated by "
        "commas, as in `https://viewer.example`.",
    )
    webhook_http: bool = Field(
        False,
        description="Send webhooks also by `http://` to other machines. By default they must be "
        "`https://`, or on this machine.",
    )
    log_level: Literal["debug", "info", "warning", "error"] = Field(
        "info", description="Lowest severity that is logged."
    )

    max_upload_bytes: int = Field(
        200 * MIB,
        ge=1,
        description="Largest motion file that is accepted, bytes; a larger one is answered 413.",
    )
    max_archive_bytes: int = Field(
        4096 * MIB, ge=1, description="Largest ZIP archive that an import accepts, bytes."
    )
    max_archive_entries: int = Field(
        100_000, ge=1, description="Most files in one imported archive."
    )
    max_archive_ratio: float = Field(
        200.0,
        ge=1,
        description="Largest unpacked size of an archive, as a multiple of its packed size.",
    )
    max_frames: int = Field(500_000, ge=1, description="Most frames in one clip.")
    max_joints: int = Field(512, ge=1, description="Most joints in one clip.")
    max_concurrent_uploads: int = Field(
        16,
        ge=1,
        description="Most uploads to store that one process receives at once. Uploads to search "
        "with have a limit of the same size. Further ones are answered 503 with Retry-After.",
    )
    max_connections: int = Field(
        1000,
        ge=1,
        description="Open connections of one process; beyond it, the one that has waited longest "
        "is closed.",
    )
    max_connections_per_address: int = Field(
        250,
        ge=1,
        description="Open connections of one process from one client address (behind a proxy: the "
        "proxy's).",
    )
    rate_limit_per_minute: int = Field(
        6000,
        ge=0,
        le=6_000_000,
        description="Calls a minute with one API key, or from one client address without a key; "
        "further ones are answered 429 with Retry-After. 0: no limit. On loopback without keys "
        "there is no limit.",
    )
    rate_limit_burst: int = Field(
        1000,
        ge=1,
        le=1_000_000,
        description="Calls at once, before `KINEDEX_RATE_LIMIT_PER_MINUTE` counts.",
    )
    request_timeout_s: float = Field(
        30.0,
        gt=0,
        le=DAY_S,
        description="Seconds a call may wait and work before it is answered 503 "
        "`deadline_exceeded`.",
    )
    query_timeout_s: float = Field(
        30.0, gt=0, le=DAY_S, description="Seconds that the analysis of an uploaded query may take."
    )

    analysis_timeout_s: float = Field(
        300.0,
        gt=0,
        le=DAY_S,
        description="Seconds that the analysis of one file may take before it is stopped.",
    )
    analysis_memory_mb: int = Field(
        2048, ge=256, description="Largest address space of an analysis process, MiB."
    )
    analysis_processes: int = Field(
        0, ge=0, description="Analysis processes of a worker; 0 takes one for each core."
    )
    job_lease_s: float = Field(
        30.0,
        gt=0,
        le=DAY_S,
        description="Seconds without a heartbeat after which another worker may take a job.",
    )
    job_heartbeat_s: float = Field(
        5.0,
        gt=0,
        description="Seconds between a worker's heartbeats on a job; at most half a lease.",
    )
    job_max_attempts: int = Field(
        3,
        ge=1,
        description="Most attempts to analyze a file if the analysis process dies because of its "
        "content.",
    )
    job_poll_s: float = Field(
        0.25,
        gt=0,
        le=DAY_S,
        description="Seconds an idle worker waits before it looks for work again.",
    )
    job_retention_days: int = Field(
        30,
        ge=0,
        le=MAX_RETENTION_DAYS,
        description="Days after which a job that has ended is removed; 0 keeps all jobs.",
    )
    audit_retention_days: int = Field(
        365,
        ge=0,
        le=MAX_RETENTION_DAYS,
        description="Days that the audit log keeps who changed or exported what; 0 keeps all.",
    )
    quarantine_days: float = Field(
        30.0,
        gt=0,
        le=MAX_RETENTION_DAYS,
        description="Days that the quarantine keeps files which the database does not name.",
    )
    refit_growth: float = Field(
        0.1,
        ge=0,
        description="Share of the library that must have changed before the models are fitted "
        "again.",
    )
    recognize_persons: bool = Field(
        True, description="Recognize people by how they move; off: no model holds a person."
    )
    wordnet: bool = Field(
        True,
        description="Look up words of similar meaning in WordNet at a fit, if it is installed.",
    )

    @field_validator("data_dir", mode="before")
    @classmethod
    def _names_a_folder(cls, value: Any) -> Any:
        if value == "":  # Path("") would be the current working directory
            raise ValueError("is empty: name a folder, or leave it unset")
        return value

    @field_validator("trusted_proxies", "cors_origins", "allowed_licenses", mode="before")
    @classmethod
    def _split(cls, value: Any) -> Any:
        if not isinstance(value, str):
            return value
        return tuple(part.strip() for part in value.split(",") if part.strip())

    @field_validator("trusted_proxies")
    @classmethod
    def _are_networks(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        for network in value:
            try:
                ipaddress.ip_network(network)
            except ValueError:
                raise ValueError(f"expected addresses or networks, found {network!r}") from None
        return value

    @field_validator("cors_origins")
    @classmethod
    def _are_origins(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        for origin in value:
            if not _ORIGIN.fullmatch(origin):
                raise ValueError(f"expected origins as in https://viewer.example, found {origin!r}")
        return tuple(origin.lower() for origin in value)

    @field_validator("root_path")
    @classmethod
    def _is_root_path(cls, value: str) -> str:
        if not _ROOT_PATH.fullmatch(value):
            raise ValueError("must begin with a slash and not end with one, as in /kinedex")
        return value

    @field_validator("job_heartbeat_s")
    @classmethod
    def _beats_within_lease(cls, value: float, others: ValidationInfo) -> float:
        lease = others.data.get("job_lease_s")
        if lease is not None and value * MIN_HEARTBEATS_PER_LEASE > lease:
            raise ValueError(f"must be at most half of {ENV_PREFIX}JOB_LEASE_S")
        return value

    @property
    def database(self) -> str:
        """The database's URL, password included: never log it."""
        if self.database_url is not None:
            return self.database_url.get_secret_value()
        return sqlite_url(self.data_dir / "kinedex.sqlite3")

    @property
    def files_dir(self) -> Path:
        """Directory of the files, or what this machine needs for those of a bucket."""
        return self.data_dir / "files"

    @property
    def files_place(self) -> FilesPlace:
        """Where the files are: `files_dir`, or a bucket. Raises ConfigurationError."""
        return self.files_at(self.files_dir)

    @property
    def cache_dir(self) -> Path:
        """Directory of what can be made again, such as the compiled parts of librosa."""
        return self.data_dir / "cache"

    @property
    def listens_on_loopback(self) -> bool:
        """Whether only this machine can reach the service."""
        return self.host in LOOPBACK_HOSTS

    @classmethod
    def settings_customise_sources(
        cls,
        settings_cls: type[BaseSettings],
        init_settings: PydanticBaseSettingsSource,
        env_settings: PydanticBaseSettingsSource,
        dotenv_settings: PydanticBaseSettingsSource,  # noqa: ARG003 - pydantic's signature
        file_secret_settings: PydanticBaseSettingsSource,  # noqa: ARG003
    ) -> tuple[PydanticBaseSettingsSource, ...]:
        """Flags override the environment, and the environment overrides the file."""
        path = Path(os.environ.get(CONFIG_FILE_ENV, CONFIG_FILE_DEFAULT))
        return init_settings, env_settings, TomlConfigSettingsSource(settings_cls, path)


def sqlite_url(path: Path) -> str:
    """The URL of the SQLite database at `path`, which may contain any characters."""
    # SQLAlchemy's URL class cannot write file names that are not UTF-8.
    return f"sqlite:///{str(path).translate(_ESCAPED_IN_URLS)}"
