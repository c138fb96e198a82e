"""The command line: `kinedex`.

Commands call the services directly on the library of the settings. `--json` prints the same JSON as
the HTTP API.
"""

from app.cli.main import main

__all__ = ["main"]
