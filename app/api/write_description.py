"""Writes the OpenAPI description to a file, for those who build clients: no service is needed.

`python -m app.api.write_description FILE`. A file that holds it already stays untouched, so that
nothing is built again in vain.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from app.api.app import create_app
from app.config import load_settings


def write_description(path: Path) -> None:
    """Write the description as JSON. Raises OSError."""
    text = json.dumps(create_app(load_settings()).openapi(), indent=1) + "\n"
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    write_description(Path(sys.argv[1]))
