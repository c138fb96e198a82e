"""The file of an SQLite database, which is checked before every transaction.

SQLite keeps the file open. If the file is deleted, or another file gets its name, SQLite goes on
writing to the old file, and a restart does not find these data. So each transaction first checks
that the name still belongs to the open file.
"""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from app.errors import DatabaseGone


class DatabaseFile:
    """The file that was opened first. Another file with the same name is refused."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._opened: os.stat_result | None = None

    @property
    def is_there(self) -> bool:
        """Whether the file exists and is not empty."""
        return self.path.is_file() and self.path.stat().st_size > 0

    def open(self) -> None:
        """Makes a missing file, private to its owner, and remembers its identity.

        SQLite gives its log the mode of this file. Raises OSError; DatabaseGone if another file
        was opened before.
        """
        if self._opened is None:
            # O_EXCL: only a new file may be opened here. If SQLite has the file open in this
            # process, closing another descriptor of it would release the locks of SQLite.
            with suppress(FileExistsError):
                os.close(os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600))
            self.watch()
        self.check()

    def watch(self) -> None:
        """Remembers the identity of the file; from now on another is refused. Raises OSError."""
        self._opened = self.path.stat()

    def check(self) -> None:
        """Raises DatabaseGone if the name does not belong to the opened file any more."""
        if self._opened is None:
            return
        try:
            is_same = os.path.samestat(self.path.stat(), self._opened)
        except OSError:
            is_same = False
        if not is_same:
            raise DatabaseGone()
