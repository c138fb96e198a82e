"""The file of an SQLite database, watched while it is open.

SQLite holds the file by its descriptor. When the file is deleted or another one takes its name,
what is written afterwards goes where nobody finds it again; so each transaction looks first.
"""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

from app.errors import DatabaseGone


class DatabaseFile:
    """The file that was opened first; any other under its name is refused."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._opened: os.stat_result | None = None

    @property
    def is_there(self) -> bool:
        """Whether there is a file with anything in it."""
        return self.path.is_file() and self.path.stat().st_size > 0

    def open(self) -> None:
        """Makes the file where there is none, for its owner only, and remembers which it is.

        SQLite gives its log the mode of this file. Raises OSError; DatabaseGone when another
        file was opened before.
        """
        if self._opened is None:
            # Only a file that is new may be opened here: closing one that SQLite has open in this
            # process would release SQLite's locks on it.
            with suppress(FileExistsError):
                os.close(os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600))
            self.watch()
        self.check()

    def watch(self) -> None:
        """Remembers which file it is; from now on any other is refused. Raises OSError."""
        self._opened = self.path.stat()

    def check(self) -> None:
        """Raises DatabaseGone unless the file that was opened still has its name."""
        if self._opened is None:
            return
        try:
            is_same = os.path.samestat(self.path.stat(), self._opened)
        except OSError:
            is_same = False
        if not is_same:
            raise DatabaseGone()
