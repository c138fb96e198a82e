"""Schemathesis reads the whole description and attacks the running service, as anybody may do.

All its checks: no server error, answers as described, calls that fit the description are taken and
others are refused, methods that are not described answer 405 with the right `Allow`, what is
deleted is gone. `schemathesis.toml` names the rules that a description cannot say.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from app.config import load_settings
from app.store import keys
from app.store.key_role import KeyRole
from app.store.store import Store
from tests.live import Live, serve

SETTINGS = Path(__file__).with_name("schemathesis.toml")
NO_GUESSING = ("--exclude-checks", "ignored_auth")
"""Without keys, every call on this machine is allowed; with keys, so many wrong ones are answered
429 instead of 401. `test_service.py` asks every call without a key and with a wrong one."""
HOOKS = Path(__file__).with_name("schemathesis_hooks.py")


@pytest.mark.slow
@pytest.mark.parametrize("phases", ["examples,coverage", "fuzzing,stateful"])
def test_without_keys(tmp_path: Path, phases: str) -> None:
    with serve(tmp_path / "data", max_upload_bytes=300_000) as live:
        _attack(live, tmp_path, "--phases", phases)


@pytest.mark.slow
@pytest.mark.parametrize("phases", ["examples,coverage", "fuzzing,stateful"])
def test_with_keys(tmp_path: Path, phases: str) -> None:
    with serve(tmp_path / "data", max_upload_bytes=300_000, rate_limit_per_minute=0) as live:
        key = _admin_key(live)
        _attack(live, tmp_path, "--phases", phases, "--header", f"Authorization: Bearer {key}")


def _admin_key(live: Live) -> str:
    settings = load_settings(data_dir=live.data_dir)
    store = Store.open(settings.database, settings.files_dir)
    with store.write() as tx:
        key = keys.create(tx, KeyRole.ADMIN, "for the test").secret
    store.close()
    return key


def _attack(live: Live, folder: Path, *options: str) -> None:
    # The events of a job that no worker takes would never end.
    command = [
        sys.executable, "-m", "schemathesis.cli", "--config-file", str(SETTINGS),
        "run", f"{live.url}/openapi.json", "--checks", "all", "--exclude-path-regex", "/events$",
        "--max-examples", "10", "--generation-deterministic", "--suppress-health-check", "all",
        "--continue-on-failure", "--no-color", *NO_GUESSING, *options,
    ]  # fmt: skip
    environment = os.environ | {"SCHEMATHESIS_HOOKS": str(HOOKS)}
    ended = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    failures = ended.stdout.partition("= FAILURES =")[2][:20_000]
    assert ended.returncode == 0, failures or ended.stdout
