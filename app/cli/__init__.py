"""The command line: `kinedex`.

The commands call the services directly, without the HTTP API. The settings name the library.
`--json` prints the same JSON as the HTTP API.
"""

from app.cli.main import main

__all__ = ["main"]
