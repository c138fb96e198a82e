"""The Python client of Kinedex, a self-hosted search engine for human motion.

    from kinedex import Kinedex

    with Kinedex("http://127.0.0.1:8000") as client:
        for clip in client.clips.list(task="kick"):
            print(clip.name, clip.duration)

`read_event` checks and reads what a service sends to a webhook. Evaluations run on the machine of
the library: `read_tables` reads the file of `kinedex evaluate ... --csv FILE` as data frames.

The package needs only httpx2. NumPy is needed for arrays and pandas for data frames; both are
imported when they are first used.
"""

from kinedex.client import AsyncKinedex, Kinedex
from kinedex.errors import JobFailed, KinedexError, PackageNeeded, Place, Unreachable
from kinedex.events import WrongSignature, read_event
from kinedex.pages import AsyncPages, Pages
from kinedex.records import Page, Record, as_json
from kinedex.sent import UNSET, FileInput, Progress
from kinedex.tables import read_tables

__all__ = [
    "UNSET",
    "AsyncKinedex",
    "AsyncPages",
    "FileInput",
    "JobFailed",
    "Kinedex",
    "KinedexError",
    "PackageNeeded",
    "Page",
    "Pages",
    "Place",
    "Progress",
    "Record",
    "Unreachable",
    "WrongSignature",
    "as_json",
    "read_event",
    "read_tables",
]
