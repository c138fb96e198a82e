"""The command line: `kinedex`.

Commands call the services directly on the library that the settings name; `--json` prints
what the HTTP API would answer.
"""

from app.cli.main import main

__all__ = ["main"]
