"""Jobs over HTTP: list, cancel, events."""

from __future__ import annotations

import json
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import httpx2
import pytest

from app.demo import demo_clips
from tests.api.conftest import assert_problem
from tests.live import Live, serve


def _events(lines: list[str]) -> list[tuple[str, dict[str, Any]]]:
    blocks = "\n".join(lines).split("\n\n")
    found = []
    for block in blocks:
        members = dict(line.split(": ", 1) for line in block.splitlines() if ": " in line)
        if "event" in members:
            found.append((members["event"], json.loads(members["data"])))
    return found


def test_events_end_with_the_job(demo_service: Live) -> None:
    clip = next(demo_clips(["elin"], ["kick"], takes=1))
    job = demo_service.upload(clip).json()["job"]
    with (
        demo_service.client() as client,
        client.stream("GET", f"/v1/jobs/{job['id']}/events") as answer,
    ):
        assert answer.headers["content-type"].startswith("text/event-stream")
        events = _events([*answer.iter_lines(), ""])
    assert [name for name, _ in events[:-1]] == ["progress"] * (len(events) - 1)
    name, last = events[-1]
    assert (name, last["state"], last["id"]) == ("done", "succeeded", job["id"])


def test_events_of_a_job_that_has_ended_are_one(demo: httpx2.Client) -> None:
    job = demo.get("/v1/jobs", params={"state": "succeeded", "limit": 1}).json()["items"][0]
    with demo.stream("GET", f"/v1/jobs/{job['id']}/events") as answer:
        events = _events([*answer.iter_lines(), ""])
    assert events == [("done", job)]


def test_a_queued_job_is_cancelled(idle_service: Live) -> None:
    clip = next(demo_clips(["elin"], ["bow"], takes=1))
    job = idle_service.upload(clip).json()["job"]
    with idle_service.client() as client:
        answer = client.delete(f"/v1/jobs/{job['id']}")
        assert answer.status_code == 202
        assert client.get(f"/v1/jobs/{job['id']}").json()["state"] == "canceled"


def test_jobs_are_listed_by_kind_and_state(demo: httpx2.Client) -> None:
    fits = demo.get("/v1/jobs", params={"kind": "fit"}).json()["items"]
    assert {job["kind"] for job in fits} == {"fit"}
    page = demo.get("/v1/jobs", params={"limit": 2}).json()
    more = demo.get("/v1/jobs", params={"limit": 2, "cursor": page["next"]}).json()
    ids = [job["id"] for job in page["items"] + more["items"]]
    assert len(set(ids)) == 4


def test_the_cursor_of_another_list_is_refused(demo: httpx2.Client) -> None:
    cursor = demo.get("/v1/clips", params={"limit": 1, "sort": "name"}).json()["next"]
    answer = demo.get("/v1/clips", params={"cursor": cursor})
    assert_problem(answer, 404, "page_not_found", "query.cursor")


def test_a_job_that_has_ended_is_deleted(idle_service: Live) -> None:
    clip = next(demo_clips(["elin"], ["bow"], takes=1))
    job = idle_service.upload(clip).json()["job"]
    with idle_service.client() as client:
        assert client.delete(f"/v1/jobs/{job['id']}").status_code == 202
        answer = client.delete(f"/v1/jobs/{job['id']}")
        assert (answer.status_code, answer.content) == (204, b"")
        assert_problem(client.delete(f"/v1/jobs/{job['id']}"), 404, "job_not_found")


def test_the_newest_fit_cannot_be_deleted(demo: httpx2.Client) -> None:
    fits = demo.get("/v1/jobs", params={"kind": "fit", "state": "succeeded"}).json()["items"]
    assert_problem(demo.delete(f"/v1/jobs/{fits[0]['id']}"), 409, "conflict")


def test_jobs_without_files_have_none_and_unknown_ones_are_not_found(demo: httpx2.Client) -> None:
    job = demo.get("/v1/jobs", params={"kind": "ingest", "limit": 1}).json()["items"][0]
    assert demo.get(f"/v1/jobs/{job['id']}/files").json()["items"] == []
    assert_problem(demo.get("/v1/jobs/none/files"), 404, "job_not_found")
    answer = demo.get(f"/v1/jobs/{job['id']}/files", params={"outcome": "lost"})
    assert_problem(answer, 422, "bad_field", "query.outcome")


@pytest.mark.slow
def test_open_streams_do_not_delay_a_stop(tmp_path: Path) -> None:
    clip = next(demo_clips(["elin"], ["bow"], takes=1))
    with ExitStack() as client_side:  # closed after the server, so that the stream is open
        with serve(tmp_path / "data") as live:
            client = client_side.enter_context(live.client())
            job = live.upload(clip).json()["job"]
            events = client.stream("GET", f"/v1/jobs/{job['id']}/events")
            lines = client_side.enter_context(events).iter_lines()
            assert next(lines) == "event: progress"
        # The server ended the stream; reading on would fail if it had been cut off.
        assert "event: done" not in list(lines)
    said = live.log.read_text()
    assert "timeout graceful shutdown exceeded" not in said
    assert "exception" not in said
