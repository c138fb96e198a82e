"""ZIP archives in memory, for tests of imports."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterable, Mapping


def zip_archive(
    entries: Mapping[str, bytes] | Iterable[tuple[str, bytes]],
    compression: int = zipfile.ZIP_DEFLATED,
) -> io.BytesIO:
    """An archive of files (name, content), open for reading at its beginning.

    Pairs may be a generator, so that a test can write a large archive, and may repeat a name.
    """
    pairs = entries.items() if isinstance(entries, Mapping) else entries
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", compression) as archive:
        for name, content in pairs:
            archive.writestr(name, content)
    buffer.seek(0)
    return buffer
