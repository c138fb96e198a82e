"""Every line of the log is JSON, even output of other programs, and none holds an API key."""

from __future__ import annotations

import json
import subprocess
import sys
import urllib.parse
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.api.guard.access_log import identity_of
from app.logs import mask_keys
from app.store import keys
from app.store.database.engine import Database
from app.store.database.schema import prepare
from app.store.keys import KeyRole
from tests.live import serve

SECRET = "Ab_-" + "x9Z" * 13
KEY = f"kx_0123456789ab_{SECRET}"
EXPECTED_TEXTS = [
    "past Python",
    "of libc",
    "RuntimeWarning: overflow encountered",
    "a warning of ours",
    "printed",
    "another program",
    "ZeroDivisionError",
    "a child, past Python",
    "ChildDied",
    "the last one",
]


def test_output_without_logging_becomes_json() -> None:
    program = [sys.executable, "-c", "from tests.noisy_program import main; main()"]
    ended = subprocess.run(program, capture_output=True, timeout=400, check=False)
    assert ended.returncode == 1
    lines: list[dict[str, Any]] = [json.loads(line) for line in ended.stderr.splitlines()]
    assert all(line["level"] and line["time"] for line in lines)
    text = ended.stderr.decode()
    assert [expected for expected in EXPECTED_TEXTS if expected not in text] == []
    assert text.count("RuntimeWarning: overflow encountered") == 2
    assert "ssss" not in text


def test_a_log_that_cannot_be_written_stops_nothing() -> None:
    """The disk of the log is full: every write to /dev/full fails with that error."""
    program = (
        "import logging, os, sys\n"
        "from app.json_stderr import json_stderr\n"
        "with json_stderr():\n"
        "    for _ in range(2000):\n"
        "        logging.getLogger('app').warning('a line of ours')\n"
        "        os.write(2, b'noise that is no JSON, and more than a pipe holds\\n' * 4)\n"
    )
    with Path("/dev/full").open("wb") as full:
        ended = subprocess.run(
            [sys.executable, "-c", program], stderr=full, timeout=300, check=False
        )
    assert ended.returncode == 0


def test_the_pattern_finds_the_keys_that_are_made(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path}/keys.sqlite3"
    prepare(url)
    database = Database(url)
    with database.write() as tx:
        for _ in range(20):
            secret = keys.create(tx, KeyRole.READ, "a").secret
            assert mask_keys(f"a {secret}, b") == "a [key], b"
    database.close()


def _encoded(key: str, times: int, every: int) -> str:
    for _ in range(times):
        key = "".join(
            f"%{ord(letter):02X}"
            if letter != "%" and place % every == 0
            else urllib.parse.quote(letter)
            for place, letter in enumerate(key)
        )
    return key


@settings(deadline=None, derandomize=True, database=None)
@given(
    before=st.text(),
    after=st.text(" .,/\"'\n?&=é"),
    times=st.integers(0, 3),
    every=st.integers(1, 3),
    case=st.sampled_from([str, str.upper, str.lower]),
)
def test_encoded_keys_are_masked_too(
    before: str, after: str, times: int, every: int, case: Any
) -> None:
    hidden = mask_keys(before + _encoded(case(KEY), times, every) + after)
    assert hidden.endswith("[key]" + after)
    for _ in range(times):
        hidden = urllib.parse.unquote(hidden)
    assert case(SECRET) not in hidden


@pytest.mark.parametrize(
    "sent",
    [
        *[KEY, f"a{KEY}"[:64], f"my-{KEY}", KEY.upper(), KEY.lower(), KEY.replace("_", "-")],
        *[KEY[:30], KEY[16:], KEY[3:], f"Bearer {KEY}", f"%6bx_{SECRET}", _encoded(KEY, 1, 1)],
        *["", "x" * 65, "a b", "a\x00", "ä"],
    ],
)
def test_an_id_that_may_hold_a_key_is_replaced(sent: str) -> None:
    identity = identity_of({"type": "http", "headers": [(b"x-request-id", sent.encode())]})
    assert identity != sent
    assert identity.isalnum()
    assert len(identity) == 32


@pytest.mark.parametrize(
    "sent",
    [
        "my-id.1",
        "7b1c0a8e-43f5-4e0b-9d7e-0d6f6f4d2a11",
        "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01",
        "01ARZ3NDEKTSV4RRFFQ69G5FAV",
        "f" * 64,
    ],
)
def test_usual_ids_are_not_replaced(sent: str) -> None:
    assert identity_of({"type": "http", "headers": [(b"x-request-id", sent.encode())]}) == sent


def test_no_part_of_a_request_brings_a_key_into_the_log(tmp_path: Path) -> None:
    with serve(tmp_path / "data") as live:
        with live.client(headers={"X-Request-Id": f"a-{KEY}"[:64]}) as client:
            for path in (f"/{KEY}", f"/v1/clips/{KEY}/file", f"/v1/clips?q={KEY}&cursor={KEY}"):
                answer = client.get(path)
                assert "kx_" not in answer.headers["x-request-id"]
            client.get("/v1/clips/" + _encoded(KEY, 2, 1))
            client.request(KEY, "/v1/clips")
            client.get("/v1/clips", headers={"Host": KEY, "Origin": KEY, "Referer": KEY})
            client.get("/v1/clips", headers={"Accept": KEY, "User-Agent": KEY, "Cookie": KEY})
            client.post("/v1/clips", content=b"x", headers={"Content-Type": KEY})
            client.delete("/v1/persons/anna")
            client.delete("/v1/persons/anna", headers={"Host": "evil.example"})
        text = live.log.read_text()
    assert [json.loads(line)["level"] for line in text.splitlines()]
    assert SECRET not in text
    assert SECRET.lower() not in text.lower()
    assert "anna" not in text
