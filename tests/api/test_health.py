"""`/readyz` of a running service reports damage of the store, and its end."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import httpx2
import pytest

from app.demo import DemoClip
from app.store.files.id_file import NAME, write_id
from tests.api.conftest import assert_problem
from tests.full_disk import fill, small_disk
from tests.live import NET_S, Live, serve, wait_until

RECOVERED_WITHIN = 60.0


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    with serve(tmp_path_factory.mktemp("health") / "data") as live:
        yield live


def assert_unhealthy(client: httpx2.Client, *locations: str) -> None:
    answer = client.get("/readyz")
    assert_problem(answer, 503, "unhealthy", *locations)
    assert answer.headers["retry-after"]
    assert {place["location"] for place in answer.json()["errors"]} == set(locations)
    assert client.get("/livez").status_code == 200


def assert_recovers(client: httpx2.Client) -> None:
    wait_until(lambda: client.get("/readyz").status_code == 200, RECOVERED_WITHIN)


def test_a_deleted_database(service: Live, take: DemoClip) -> None:
    path, away = service.data_dir / "kinedex.sqlite3", service.data_dir / "away"
    with service.client() as client:
        path.rename(away)
        try:
            assert_unhealthy(client, "database")
            # A clip that is acknowledged now would be lost with the process.
            assert_problem(service.upload(take), 500, "database_gone")
            assert not path.exists()
        finally:
            away.rename(path)
        assert_recovers(client)


@pytest.mark.parametrize("harm", ["missing", "empty", "another"])
def test_a_folder_of_files_that_is_not_there(service: Live, take: DemoClip, harm: str) -> None:
    files, away = service.data_dir / "files", service.data_dir / "unmounted"
    with service.client() as client:
        files.rename(away)
        try:
            if harm == "empty":
                files.mkdir()
            elif harm == "another":
                write_id(files, "library_of_others")
            assert_unhealthy(client, "files")
            assert service.upload(take).status_code == 500
        finally:
            if files.exists():
                (files / NAME).unlink(missing_ok=True)
                files.rmdir()  # nothing was stored there
            away.rename(files)
        assert_recovers(client)
        assert client.delete(f"/v1/clips/{_stored(service, take)}").status_code == 204


def test_a_damaged_database(service: Live) -> None:
    path = service.data_dir / "kinedex.sqlite3"
    content = path.read_bytes()
    with service.client() as client, path.open("r+b") as file:
        file.write(os.urandom(len(content)))
        file.flush()
        try:
            wait_until(lambda: client.get("/readyz").status_code == 503, RECOVERED_WITHIN)
            assert_unhealthy(client, "database")
            assert client.get("/livez").status_code == 200
        finally:
            file.seek(0)
            file.write(content)
            file.flush()
        assert_recovers(client)


def test_a_full_disk(tmp_path: Path, take: DemoClip) -> None:
    with small_disk(tmp_path / "disk", 32) as disk, serve(disk / "data") as live:
        clip = _stored(live, take)
        stored = disk / "data" / "files"
        wait_until((disk / "data" / "kinedex.sqlite3.reserve").exists, RECOVERED_WITHIN)
        with live.client() as client:
            filler = fill(disk)
            wait_until(lambda: client.get("/readyz").status_code == 503, RECOVERED_WITHIN)
            assert_unhealthy(client, "disk")
            other = replace(take, content=take.content + b"\n" * 99)
            assert_problem(live.upload(other), 507, "disk_full")
            assert client.delete(f"/v1/clips/{clip}").status_code == 204
            assert_problem(client.get(f"/v1/clips/{clip}"), 404, "clip_not_found")
            assert [path for path in stored.rglob("*") if len(path.name) == 64] == []
            filler.unlink()
            assert_recovers(client)


def test_a_damaged_file_is_never_sent(service: Live, take: DemoClip) -> None:
    clip = _stored(service, take)
    with service.client() as client:
        assert client.get(f"/v1/clips/{clip}/file").content == take.content
        (path,) = [p for p in (service.data_dir / "files").rglob("*") if len(p.name) == 64]
        with path.open("r+b") as file:
            file.seek(len(take.content) // 2)
            flipped = take.content[len(take.content) // 2] ^ 1
            file.write(bytes([flipped]))
        assert_problem(client.get(f"/v1/clips/{clip}/file"), 500, "file_damaged")
        # Everything else can be answered, so the service stays ready, and tells it.
        wait_until(lambda: _warnings(client) == ["stored files that are damaged: 1"], NET_S)
        assert service.upload(take).status_code == 200  # the same bytes again mend it
        assert client.get(f"/v1/clips/{clip}/file").content == take.content
        wait_until(lambda: _warnings(client) == [], NET_S)
        path.rename(path.with_suffix(".away"))
        assert client.get(f"/v1/clips/{clip}/file").status_code >= 400
        wait_until(lambda: _warnings(client) == ["stored files that are missing: 1"], NET_S)
        path.with_suffix(".away").rename(path)
        wait_until(lambda: _warnings(client) == [], NET_S)
        assert client.delete(f"/v1/clips/{clip}").status_code == 204


def _warnings(client: httpx2.Client) -> list[str]:
    ready = client.get("/readyz")
    assert ready.status_code == 200
    assert {place["location"] for place in ready.json()["warnings"]} <= {"files"}
    return [place["message"] for place in ready.json()["warnings"]]


def test_only_its_owner_can_read_the_data_directory(tmp_path: Path) -> None:
    """`serve` creates the directory, so that the service does not."""
    made = tmp_path / "open"
    with serve(made) as live:
        made.chmod(0o755)
        assert stat.S_IMODE((made / "files").stat().st_mode) == 0o700
        assert stat.S_IMODE((made / "kinedex.sqlite3").stat().st_mode) == 0o600
        assert live.log.exists()
    with serve(made) as live:
        assert "is open to all accounts of this machine (mode 755)" in live.log.read_text()
    assert stat.S_IMODE(made.stat().st_mode) == 0o755


def _stored(live: Live, clip: DemoClip) -> str:
    clip_id: str = live.upload(clip).json()["clip"]["id"]
    return clip_id
