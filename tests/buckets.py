"""An S3-compatible store for tests, by moto, and buckets in it.

One server runs in each process of tests that needs one. It holds everything in memory, and checks
no signature: tests of keys are tests of what Kinedex sends.
"""

from __future__ import annotations

import itertools
import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import boto3
from moto.server import ThreadedMotoServer

from app.store.files.bucket import Bucket

REGION, ACCESS_KEY, SECRET_KEY = "us-east-1", "tests", "tests-secret"
_numbers = itertools.count()


class Buckets:
    """A running store. endpoint: its URL."""

    def __init__(self, endpoint: str) -> None:
        self.endpoint = endpoint
        self.client: Any = boto3.client(
            "s3",
            endpoint_url=endpoint,
            region_name=REGION,
            aws_access_key_id=ACCESS_KEY,
            aws_secret_access_key=SECRET_KEY,
        )

    def new(self, folder: Path, *, cache_bytes: int = 2**30) -> Bucket:
        """A new empty bucket, with a prefix; folder: of this machine, see `Bucket`."""
        name = f"kinedex-{next(_numbers)}"
        self.client.create_bucket(Bucket=name)
        return Bucket(
            f"s3://{name}/some/library",
            folder,
            self.endpoint,
            REGION,
            ACCESS_KEY,
            SECRET_KEY,
            cache_bytes,
        )

    def write(self, bucket: Bucket, name: str, content: bytes) -> None:
        """Writes an object behind the back of Kinedex."""
        self.client.put_object(Bucket=_bucket_of(bucket), Key=_key(bucket, name), Body=content)

    def read(self, bucket: Bucket, name: str) -> bytes:
        """The bytes of an object."""
        found = self.client.get_object(Bucket=_bucket_of(bucket), Key=_key(bucket, name))
        return bytes(found["Body"].read())

    def names(self, bucket: Bucket) -> list[str]:
        """The names of all objects below the prefix, sorted."""
        pages = self.client.get_paginator("list_objects_v2").paginate(Bucket=_bucket_of(bucket))
        keys = [one["Key"] for page in pages for one in page.get("Contents", [])]
        return sorted(key.removeprefix(_key(bucket, "")) for key in keys)


def environment(bucket: Bucket) -> dict[str, str]:
    """The settings of a process of Kinedex whose files are in the bucket."""
    return {
        "KINEDEX_FILES_URL": bucket.url,
        "KINEDEX_FILES_ENDPOINT": bucket.endpoint or "",
        "KINEDEX_FILES_REGION": REGION,
        "KINEDEX_FILES_ACCESS_KEY": ACCESS_KEY,
        "KINEDEX_FILES_SECRET_KEY": SECRET_KEY,
    }


@contextmanager
def running() -> Iterator[Buckets]:
    """A new store, which ends with the block."""
    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    try:
        host, port = server.get_host_and_port()
        yield Buckets(f"http://{host}:{port}")
    finally:
        server.stop()


def _bucket_of(bucket: Bucket) -> str:
    return bucket.url.split("/")[2]


def _key(bucket: Bucket, name: str) -> str:
    return "/".join([*bucket.url.split("/")[3:], name])
