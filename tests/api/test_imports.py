"""Imports over HTTP."""

from __future__ import annotations

import httpx2

from app.demo import demo_clips
from tests.api.conftest import assert_problem
from tests.formats.npz.files import npy
from tests.live import Live
from tests.people import CONVENTIONS, person
from tests.zip_archives import zip_archive


def test_an_archive_with_a_manifest(demo_service: Live) -> None:
    clip = next(demo_clips(["farid"], ["bow"], takes=1))
    manifest = "path,person,task,words,license\nin/bow.bvh,farid,bow,bow polite,CC0-1.0\n"
    content = zip_archive(
        {
            "manifest.csv": manifest.encode(),
            "in/bow.bvh": clip.content,
            "in/broken.bvh": b"HIERARCHY\nROOT Hips\n{\n",
        }
    ).getvalue()
    with demo_service.client() as client:
        answer = client.post("/v1/imports", files={"archive": ("a.zip", content)})
        assert answer.status_code == 202
        assert set(answer.json()) == {"job"}
        job = demo_service.wait_for_job(answer.json()["job"]["id"])
        assert job["state"] == "succeeded"
        assert "in/bow.bvh" in str(job["result"])
        broken = {line["path"]: line["error"] for line in job["result"]["files"]}["in/broken.bvh"]
        assert set(broken) == {"type", "title", "status", "detail", "code", "errors"}
        found = client.get("/v1/clips", params={"person": "farid"}).json()["items"]
    assert [(clip["task"], clip["words"], clip["state"]) for clip in found] == [
        ("bow", ["bow", "polite"], "ready")
    ]


def test_a_manifest_bomb_fails_at_once_and_lists_of_jobs_stay_small(demo_service: Live) -> None:
    rows = "".join(f"missing/clip_{i:06d}.bvh,ada,walk\n" for i in range(200_000))
    content = zip_archive({"manifest.csv": f"path,person,task\n{rows}".encode()}).getvalue()
    with demo_service.client() as client:
        bombs = [client.post("/v1/imports", files={"archive": ("a.zip", content)}) for _ in "123"]
        for bomb in bombs:
            job = demo_service.wait_for_job(bomb.json()["job"]["id"])
            assert (job["state"], job["error"]["code"]) == ("failed", "too_large")
            place = {"location": "manifest.csv line 100002", "message": "more than 100000 rows"}
            assert job["error"]["errors"] == [place]
        assert len(client.get("/v1/jobs", params={"kind": "import"}).content) < 20_000


def test_the_files_of_a_large_import_are_paged(demo_service: Live) -> None:
    names = [f"{i:04d}.bvh" for i in range(250)]
    rows = "".join(f"gone_{i:06d}.bvh\n" for i in range(300))
    files = dict.fromkeys(names, b"") | {"manifest.csv": f"path\n{rows}".encode()}
    with demo_service.client() as client:
        answer = client.post(
            "/v1/imports", files={"archive": ("a.zip", zip_archive(files).getvalue())}
        )
        job = demo_service.wait_for_job(answer.json()["job"]["id"])
        counts = {k: v for k, v in job["result"].items() if k != "files"}
        assert counts == {
            "total": 550,
            "new": 0,
            "updated": 0,
            "unchanged": 0,
            "conflicting": 0,
            "failed": 250,
            "skipped": 0,
            "deleted": 0,
            "absent": 300,
            "unmatched": 0,
            "warnings": {},
            "files_left_out": 450,
        }
        assert len(job["result"]["files"]) == 100
        (listed,) = client.get("/v1/jobs", params={"kind": "import", "limit": 1}).json()["items"]
        assert "files" not in listed["result"]
        path, found, cursor = f"/v1/jobs/{job['id']}/files", [], None
        while cursor is not None or not found:
            asked = {"outcome": "failed", "limit": 100} | ({"cursor": cursor} if cursor else {})
            page = client.get(path, params=asked).json()
            found += page["items"]
            cursor = page["next"]
        assert [line["path"] for line in found] == names
        assert {line["error"]["code"] for line in found} == {"empty_file"}
        absent = client.get(path, params={"outcome": "absent", "limit": 1000}).json()
    assert (len(absent["items"]), absent["next"]) == (100, None)


def test_a_zip_of_npy_clips_is_an_archive_and_not_a_clip(demo_service: Live) -> None:
    array = npy(person(CONVENTIONS["Kinect"], frames=20).positions)
    content = zip_archive({"walk_01.npy": array, "walk_02.npy": array[:200]}).getvalue()
    with demo_service.client() as client:
        answer = client.post("/v1/imports", files={"archive": ("a.zip", content)})
        assert answer.status_code == 202
        result = demo_service.wait_for_job(answer.json()["job"]["id"])["result"]
        assert {line["path"] for line in result["files"]} == {"walk_01.npy", "walk_02.npy"}
        reply = client.post("/v1/clips", files={"file": ("a.zip", content)}).json()
        demo_service.wait_for_job(reply["job"]["id"])
        found = [*(line["clip_id"] for line in result["files"]), reply["clip"]["id"]]
        clip = client.get(f"/v1/clips/{reply['clip']['id']}").json()
        for clip_id in filter(None, found):
            client.delete(f"/v1/clips/{clip_id}")
    assert (clip["state"], clip["error"]["code"]) == ("failed", "format_not_supported")
    assert "Import it" in clip["error"]["detail"]


def test_a_file_that_is_no_archive_is_refused(idle: httpx2.Client) -> None:
    answer = idle.post("/v1/imports", files={"archive": ("a.zip", b"")})
    assert_problem(answer, 422, "empty_file")
    answer = idle.post("/v1/imports", files={"archive": ("a.zip", b"no archive at all")})
    assert answer.status_code in {415, 422}
    assert_problem(answer, answer.status_code, answer.json()["code"])


def test_an_archive_that_is_cut_off_fails_with_a_reason(demo_service: Live) -> None:
    content = zip_archive({"a.bvh": b"HIERARCHY"}).getvalue()[:-30]
    with demo_service.client() as client:
        answer = client.post("/v1/imports", files={"archive": ("a.zip", content)})
    assert answer.status_code == 202
    job = demo_service.wait_for_job(answer.json()["job"]["id"])
    assert job["state"] == "failed"
    assert set(job["error"]) == {"type", "title", "status", "detail", "code", "errors"}
