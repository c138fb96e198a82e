"""The store of buckets that the tests of files share."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests import buckets


@pytest.fixture(scope="session")
def s3() -> Iterator[buckets.Buckets]:
    with buckets.running() as server:
        yield server
