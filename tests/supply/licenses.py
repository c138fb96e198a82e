"""Prints the licenses of everything that runs: `make licenses`.

The Python packages are those of `docker/requirements.txt`, the packages of the pages are those that
are compiled into them. Kinedex is under Apache-2.0: all of these may be distributed with it.
"""

from __future__ import annotations

import json
import re
import sys
from dataclasses import dataclass
from email.message import Message
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import Path
from typing import cast

ROOT = Path(__file__).resolve().parents[2]
REQUIREMENTS = ROOT / "docker" / "requirements.txt"
NPM_LOCK = ROOT / "app" / "web" / "package-lock.json"
COMPILED_IN = frozenset({"svelte"})
"""Development packages of the pages, parts of which are compiled into them."""

PERMISSIVE = frozenset(
    {
        "0BSD",
        "Apache-2.0",
        "Apache-2.0 WITH LLVM-exception",
        "BSD",
        "BSD-2-Clause",
        "BSD-3-Clause",
        "ISC",
        "MIT",
        "MIT-0",
        "MIT-CMU",
        "PSF-2.0",
    }
)
"""Licenses that ask for no more than a notice (SPDX; BSD stands for one of its variants)."""
LIBRARIES = {
    "certifi": "MPL-2.0",
    "psycopg": "LGPL-3.0-only",
    "psycopg-binary": "LGPL-3.0-only",
    "soxr": "LGPL-2.1-or-later",
}
"""Packages that come unchanged as files of their own, so that anybody can replace them: all that
their licenses ask for. librosa brings certifi and soxr; psycopg is the driver of PostgreSQL."""
_PINNED = re.compile(r"^([A-Za-z0-9_.-]+)==([^\s;]+)", re.MULTILINE)
_OLD_NAMES = (
    (r"apache software|apache license,? version 2", "Apache-2.0"),
    (r"bsd[- ]3|3-clause", "BSD-3-Clause"),
    (r"\bbsd\b|redistribution and use in source and binary forms", "BSD"),
    (r"\bisc\b", "ISC"),
    (r"python software foundation|\bpsf\b", "PSF-2.0"),
    (r"\bmit\b", "MIT"),
    (r"\bmpl[- ]2\.0\b|mozilla public license 2\.0", "MPL-2.0"),
)
"""Names before SPDX, as patterns on lower-case text."""
_BETWEEN = re.compile(r"\s+(?:AND|OR)\s+|[()]")


@dataclass(frozen=True, slots=True)
class Licensed:
    """A package with its license (SPDX), empty if it is unknown."""

    name: str
    version: str
    license: str

    @property
    def is_permissive(self) -> bool:
        """Whether Apache-2.0 software may bring the package along."""
        if LIBRARIES.get(self.name) == self.license:
            return True
        parts = [part for part in _BETWEEN.split(self.license) if part]
        return bool(parts) and all(part in PERMISSIVE for part in parts)


def pinned(text: str) -> dict[str, str]:
    """The versions in a file of requirements, by name."""
    return dict(_PINNED.findall(text))


def python_packages() -> list[Licensed]:
    """The packages of the image that are installed here; others are for other systems."""
    found = []
    for name, version in pinned(REQUIREMENTS.read_text()).items():
        try:
            described = cast(Message, metadata(name))
        except PackageNotFoundError:
            continue
        found.append(Licensed(name, version, license_of(described)))
    return found


def license_of(described: Message) -> str:
    """The license in the metadata of a Python package, in its new or its old form."""
    expression = described.get("License-Expression")
    if expression:
        return str(expression)
    classifiers = [
        text.rpartition(" :: ")[2]
        for text in described.get_all("Classifier") or ()
        if text.startswith("License ::")
    ]
    # A text can be the whole license, and its first lines name it.
    for text in (*classifiers, str(described.get("License") or "")[:500]):
        if text in PERMISSIVE:
            return text
        for pattern, spdx in _OLD_NAMES:
            if re.search(pattern, text.lower()):
                return spdx
    return ""


def page_packages() -> list[Licensed]:
    """The packages of npm that are compiled into the pages."""
    locked = json.loads(NPM_LOCK.read_text())["packages"]
    named = [(path.rpartition("node_modules/")[2], entry) for path, entry in locked.items() if path]
    return [
        Licensed(name, entry["version"], entry.get("license", ""))
        for name, entry in named
        if not entry.get("dev") or name in COMPILED_IN
    ]


def main() -> int:
    """Print all packages; the exit code is 1 if one of them is not permissive."""
    packages = sorted({*python_packages(), *page_packages()}, key=lambda one: one.name.lower())
    for one in packages:
        mark = "" if one.is_permissive else "   NOT KNOWN TO FIT APACHE-2.0"
        sys.stdout.write(f"{one.name:<36}{one.version:<14}{one.license}{mark}\n")
    return 0 if all(one.is_permissive for one in packages) else 1


if __name__ == "__main__":
    sys.exit(main())
