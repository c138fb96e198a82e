"""Folders of the library: they are their maker's own, and on disk before anything is in them."""

from __future__ import annotations

import logging
import os
import stat
from pathlib import Path

_log = logging.getLogger(__name__)

PRIVATE = 0o700
"""Mode of every folder that Kinedex makes: motion capture identifies people."""


def make_private(folder: Path) -> None:
    """Makes a folder that only its owner can enter; one that is there stays as it is.

    Folders above it that are missing are made too, with the usual mode. Raises OSError.
    """
    folder.parent.mkdir(parents=True, exist_ok=True)
    folder.mkdir(mode=PRIVATE, exist_ok=True)


def make_private_synced(folder: Path) -> None:
    """Makes a folder with its parents, all private, each synced into the one above it."""
    if folder.is_dir():
        return
    make_private_synced(folder.parent)
    folder.mkdir(mode=PRIVATE, exist_ok=True)
    sync_folder(folder.parent)


def sync_folder(folder: Path) -> None:
    """Sees to it that the names in a folder are on disk."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def warn_if_open(folder: Path) -> None:
    """Logs a warning where every account of this machine can look into the folder.

    Only a warning: an operator may have made the folder so on purpose.
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
