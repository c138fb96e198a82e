"""The settings that say where the uploaded files are: in the data directory, or in a bucket."""

from __future__ import annotations

from pathlib import Path

from pydantic import Field, SecretStr
from pydantic_settings import BaseSettings

from app.errors import ConfigurationError
from app.store.files.bucket import DEFAULT_CACHE_BYTES, Bucket, FilesPlace


class FilesSettings(BaseSettings):
    """Where the files are, and the keys for that."""

    files_url: str | None = Field(
        None,
        pattern=r"^s3://[^/?#\s]+(/[^?#\s]*)?$",
        description="Bucket of an S3-compatible store for the uploaded files, as in "
        "`s3://bucket/prefix`; unset: the data directory.",
    )
    files_endpoint: str | None = Field(
        None,
        pattern=r"^https?://\S+$",
        description="URL of that store, as in `http://garage:3900`; unset: Amazon's.",
    )
    files_region: str | None = Field(None, description="Region of the bucket.")
    files_access_key: SecretStr | None = Field(
        None,
        description="Access key of the bucket; unset: the usual variables of AWS, or the role of "
        "the machine.",
    )
    files_secret_key: SecretStr | None = Field(None, description="Secret of the access key.")
    files_keys_file: Path | None = Field(
        None,
        description="File with the access key in its first line and the secret in its second, "
        "instead of both settings.",
    )
    files_cache_bytes: int = Field(
        DEFAULT_CACHE_BYTES,
        ge=0,
        description="Bytes of copies of files from a bucket that one machine keeps in its data "
        "directory, for analyses and players.",
    )

    def files_at(self, folder: Path) -> FilesPlace:
        """The place of the files; folder: of this machine. Raises ConfigurationError."""
        if self.files_url is None:
            return folder
        access, secret = self._keys()
        return Bucket(
            self.files_url,
            folder,
            self.files_endpoint,
            self.files_region,
            access,
            secret,
            self.files_cache_bytes,
        )

    def _keys(self) -> tuple[str | None, str | None]:
        if self.files_keys_file is None:
            return self._given_keys()
        try:
            access, secret = self.files_keys_file.read_text(encoding="utf-8").split()
        except (OSError, ValueError) as error:
            raise ConfigurationError(
                f"KINEDEX_FILES_KEYS_FILE: {self.files_keys_file} must hold two lines, the access "
                "key and the secret."
            ) from error
        return access, secret

    def _given_keys(self) -> tuple[str | None, str | None]:
        access, secret = self.files_access_key, self.files_secret_key
        if access is None and secret is None:
            return None, None
        if access is None or secret is None:
            raise ConfigurationError(
                "KINEDEX_FILES_ACCESS_KEY and KINEDEX_FILES_SECRET_KEY go together."
            )
        return access.get_secret_value(), secret.get_secret_value()
