"""API keys on the command line."""

from __future__ import annotations

from tests.cli.conftest import Kinedex


def test_a_key_is_shown_once_and_can_be_revoked(kinedex: Kinedex) -> None:
    made = kinedex("keys", "create", "--role", "write", "--name", "studio", "--json").json()
    assert made.keys() == {"id", "role", "source", "expires_at", "key"}
    listed = {key["id"]: key for key in kinedex("keys", "list", "--json").json()}
    assert listed[made["id"]]["role"] == "write"
    assert listed[made["id"]]["name"] == "studio"
    assert listed[made["id"]]["revoked_at"] is None
    assert made["key"] not in kinedex("keys", "list").out
    assert kinedex("keys", "revoke", made["id"]).code == 0
    again = {key["id"]: key for key in kinedex("keys", "list", "--json").json()}
    assert again[made["id"]]["revoked_at"] is not None


def test_only_the_key_goes_to_standard_output(kinedex: Kinedex) -> None:
    """So a script can store it: KEY=$(kinedex keys create)."""
    ended = kinedex("keys", "create")
    assert len(ended.out.split()) == 1
    assert "not shown again" in ended.err
    assert ended.out.strip() not in ended.err


def test_a_missing_key_is_refused(kinedex: Kinedex) -> None:
    ended = kinedex("keys", "revoke", "key_of_nobody")
    assert ended.code == 1
    assert "key_of_nobody" in ended.err


def test_unknown_roles_are_refused(kinedex: Kinedex) -> None:
    assert kinedex("keys", "create", "--role", "king").code == 2
