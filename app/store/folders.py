"""Folders of a library: private to their owner, and synced to disk before files go into them."""

from __future__ import annotations

import logging
import os
import stat
from pathlib import Path

_log = logging.getLogger(__name__)

PRIVATE = 0o700
"""Mode of every folder that Kinedex makes: motion capture identifies people."""


def make_private(folder: Path) -> None:
    """Makes a folder that only its owner can enter; an existing folder stays as it is.

    Missing parent folders are made with the usual mode. Raises OSError.
    """
    folder.parent.mkdir(parents=True, exist_ok=True)
    folder.mkdir(mode=PRIVATE, exist_ok=True)


def make_private_synced(folder: Path) -> None:
    """Makes a folder and its missing parents, all private; each name is synced to disk.

    Raises OSError.
    """
    if folder.is_dir():
        return
    make_private_synced(folder.parent)
    folder.mkdir(mode=PRIVATE, exist_ok=True)
    sync_folder(folder.parent)


def sync_folder(folder: Path) -> None:
    """Writes the names in a folder to disk, so that they survive a power cut. Raises OSError."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def warn_if_open(folder: Path) -> None:
    """Logs a warning if every account of this machine can read the folder.

    It is a warning only, because an operator may want these rights.
    """
    if not folder.is_dir():
        return
    mode = stat.S_IMODE(folder.stat().st_mode)
    if mode & stat.S_IRWXO:
        _log.warning(
            "the data directory %s is open to all accounts of this machine (mode %o): "
            "`chmod 700` closes it",
            folder,
            mode,
        )
