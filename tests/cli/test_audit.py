"""The audit log on the command line."""

from __future__ import annotations

import csv
import io

import pytest

from app.cli import output
from tests.cli.conftest import Kinedex

NO_TIMES = ["soon", "90", "9999999d", "2027-13-01", "0001-01-01T00:00+23:00"]
PAST = ["0m", "2020-01-01"]


def test_commands_are_recorded_and_shown(kinedex: Kinedex, monkeypatch: pytest.MonkeyPatch) -> None:
    made = kinedex("keys", "create", "--expires", "90d", "--source", "lab", "--json").json()
    assert made["source"] == "lab"
    assert made["expires_at"] is not None
    listed = {key["id"]: key for key in kinedex("keys", "list", "--json").json()}[made["id"]]
    assert (listed["source"], listed["expires_at"]) == ("lab", made["expires_at"])
    assert listed["used_at"] is None
    kinedex("keys", "revoke", made["id"])
    found = kinedex("audit", "--since", "1h", "--json").json()["items"]
    assert [one["action"] for one in found[:2]] == ["kinedex keys revoke", "kinedex keys create"]
    assert found[0]["details"] == {"revoked_key_id": made["id"]}
    assert found[0]["address"] is None
    shown = kinedex("audit", "--action", "kinedex keys create", "--csv")
    rows = list(csv.DictReader(io.StringIO(shown.out)))
    assert made["id"] in rows[0]["details"]
    assert {row["action"] for row in rows} == {"kinedex keys create"}
    monkeypatch.setattr(output.console, "width", 200)
    assert made["id"] in kinedex("audit").out
    assert kinedex("audit", "--until", "2001-01-01", "--json").json()["items"] == []


@pytest.mark.parametrize("time", NO_TIMES + PAST)
def test_times_that_are_none_are_refused(kinedex: Kinedex, time: str) -> None:
    assert kinedex("keys", "create", "--expires", time).code == 2


def test_reading_commands_are_not_recorded(kinedex: Kinedex) -> None:
    before = kinedex("audit", "--limit", "0", "--json").json()["items"]
    kinedex("clips", "list")
    kinedex("status")
    assert kinedex("audit", "--limit", "0", "--json").json()["items"] == before
