"""Webhooks over HTTP: what may be registered, and events that arrive when jobs end."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import httpx2
import pytest

from app.demo import demo_clips
from app.services.webhooks.sending import signed
from app.store.key_role import KeyRole
from tests.api.conftest import assert_problem
from tests.api.test_service import _make_keys
from tests.live import NET_S, Live, serve, wait_until
from tests.receivers import receiving

GOOD_URLS = ["https://example.com/x?y=z", "https://10.0.0.1:8443/", "http://localhost:9/"]
GOOD_URLS += ["http://127.0.0.1/", "http://[::1]:8080/hook"]
BAD_URLS = ["http://example.com/", "ftp://localhost/", "localhost:80", "", "https://", "http://"]
BAD_URLS += ["http://localhost.evil.example/", "http://127.0.0.1.evil.example/"]
BAD_URLS += ["http://2130706433/"]
BAD_URLS += ["https://me:secret@example.com/", "https://example.com/#x", "https://example.com/ x"]
BAD_URLS += ["https://example.com/\r\nHost: x", "https://[::1", "https://example.com:x/"]
BAD_URLS += ["https://ü/"]
BAD_URLS += ["http://169.254.169.254/latest/meta-data", "https://example.com/" + "x" * 2000]


@pytest.fixture
def made(idle: httpx2.Client) -> Iterator[dict[str, Any]]:
    """A webhook that is switched off."""
    new = {"url": "https://example.com/", "enabled": False}
    webhook = idle.post("/v1/webhooks", json=new).json()
    yield webhook
    idle.delete(f"/v1/webhooks/{webhook['id']}")


@pytest.mark.parametrize("url", GOOD_URLS)
def test_https_and_this_machine_are_allowed(idle: httpx2.Client, url: str) -> None:
    created = idle.post("/v1/webhooks", json={"url": url, "enabled": False})
    assert created.status_code == 201, created.text
    assert idle.delete(f"/v1/webhooks/{created.json()['id']}").status_code == 204


@pytest.mark.parametrize("url", BAD_URLS)
def test_other_addresses_are_refused(idle: httpx2.Client, url: str) -> None:
    answer = idle.post("/v1/webhooks", json={"url": url})
    assert_problem(answer, 422, "bad_field", "body.url")


def test_a_secret_is_shown_once(idle: httpx2.Client, made: dict[str, Any]) -> None:
    assert made["secret"].startswith("whsec_")
    shown = idle.get(f"/v1/webhooks/{made['id']}").json()
    assert shown == {name: value for name, value in made.items() if name != "secret"}
    assert shown in idle.get("/v1/webhooks").json()["items"]


@pytest.mark.parametrize("secret", ["x", "whsec_", "whsec_AAAA", "whsec_ä", "whsec_" + "A" * 90])
def test_a_secret_must_be_long_and_base64(idle: httpx2.Client, secret: str) -> None:
    answer = idle.post("/v1/webhooks", json={"url": "https://example.com/", "secret": secret})
    assert_problem(answer, 422, "bad_field", "body.secret")


def test_a_webhook_can_be_changed(idle: httpx2.Client, made: dict[str, Any]) -> None:
    path = f"/v1/webhooks/{made['id']}"
    changed = idle.patch(path, json={"events": ["fit.failed"], "enabled": True}).json()
    assert (changed["events"], changed["enabled"]) == (["fit.failed"], True)
    assert idle.patch(path, json={"enabled": False}).json()["events"] == ["fit.failed"]
    assert_problem(idle.patch(path, json={"events": ["x"]}), 422, "bad_field", "body.events")
    assert_problem(idle.get("/v1/webhooks/nope"), 404, "webhook_not_found")


def test_only_administrators_see_webhooks(tmp_path: Path) -> None:
    with serve(tmp_path / "data") as live:
        secrets = _make_keys(live.data_dir)
        for role, status in ((KeyRole.READ, 403), (KeyRole.WRITE, 403), (KeyRole.ADMIN, 200)):
            with live.client(headers={"X-API-Key": secrets[role]}) as client:
                assert client.get("/v1/webhooks").status_code == status


def test_the_end_of_a_job_arrives_signed(tmp_path: Path) -> None:
    clip = next(demo_clips(["ada"], ["bow"], takes=1))
    with receiving() as receiver, serve(tmp_path / "data", worker=True) as live:
        receiver.answers.append(500)
        with live.client() as client:
            webhook = client.post("/v1/webhooks", json={"url": receiver.url}).json()
            job = live.upload(clip).json()["job"]
            wait_until(lambda: len(receiver.received) >= 2, NET_S)
            path = f"/v1/webhooks/{webhook['id']}"
            wait_until(lambda: client.get(path).json()["failures"] == 0, NET_S)
            last = client.get(path).json()["last_delivery"]
    (first, body), (second, again) = receiver.received[:2]
    event = json.loads(body)
    assert (event["type"], event["data"]["id"]) == ("ingest.succeeded", job["id"])
    assert (again, second["webhook-id"]) == (body, first["webhook-id"])
    assert (last["state"], last["status"], last["attempt"]) == ("delivered", 204, 2)
    for headers in (first, second):
        moment = datetime.fromtimestamp(int(headers["webhook-timestamp"]), UTC)
        expected = signed(headers["webhook-id"], webhook["secret"], body, moment)
        assert headers["webhook-signature"] == expected["webhook-signature"]


def test_an_event_survives_the_death_of_the_worker(tmp_path: Path) -> None:
    """The job ends while nobody delivers; the worker that ended it is killed."""
    clip = next(demo_clips(["ada"], ["bow"], takes=1))
    with receiving() as receiver, serve(tmp_path / "data") as live, live.client() as client:
        created = client.post("/v1/webhooks", json={"url": receiver.url}).json()
        job = live.upload(clip).json()["job"]
        with _worker(live) as worker:
            live.wait_for_job(job["id"])
            worker.send_signal(signal.SIGKILL)
        with _worker(live):
            wait_until(lambda: receiver.received, NET_S)
        assert json.loads(receiver.received[0][1])["data"]["id"] == job["id"]
        assert client.get(f"/v1/webhooks/{created['id']}").json()["id"] == created["id"]


@contextmanager
def _worker(live: Live) -> Iterator[subprocess.Popen[bytes]]:
    """A worker process over the library of a service."""
    command = [sys.executable, "-m", "app.worker"]
    environment = os.environ | {"KINEDEX_DATA_DIR": str(live.data_dir)}
    with live.log.with_suffix(".worker.log").open("ab") as log:
        process = subprocess.Popen(command, env=environment, stdout=log, stderr=log)
        yield process
        process.terminate()
        process.wait(300)
