"""The client against a running service: answers, pages, uploads, jobs and failures."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import numpy as np
import pytest

from app.demo import DemoClip
from kinedex import JobFailed, Kinedex, KinedexError, Unreachable, as_json
from kinedex.types.bodies import SearchExample
from tests.live import NO_TLS, Live

CLIPS = 12


def _kick(client: Kinedex) -> str:
    found = client.clips.list(task="kick", person="ada", sort="name").first()
    assert found is not None
    return found.id


def test_a_list_is_fetched_page_by_page(client: Kinedex) -> None:
    kicks = list(client.clips.list(task=["kick", "walk"], not_person="bruno"))
    assert {(clip.person, clip.task) for clip in kicks} == {("ada", "kick"), ("ada", "walk")}
    some = client.clips.list(sort="name", limit=5)
    assert [clip.name for clip in some] == [clip.name for clip in some]
    assert len(list(some)) == 5
    assert list(client.clips.list(limit=0)) == []
    assert client.clips.list(task="nosuch").first() is None
    of_ada = client.clips.list(task="kick", person="ada")
    assert client.clips.list(task="kick", person="ada", limit=1).total() == len(list(of_ada)) > 0
    assert client.labels.persons().total() >= 2


def test_lists_and_searches_are_filtered_by_metadata(client: Kinedex) -> None:
    clip = _kick(client)
    client.clips.update(clip, metadata={"condition": "tired", "age": 30})
    try:
        for condition in ({"meta.condition": "tired"}, {"meta.age.min": 20, "meta.age.max": 30}):
            assert [one.id for one in client.clips.list(task="kick", filter=condition)] == [clip]
            hits = client.search.motion(clip, filter=condition, include_self=True)
            assert [hit.clip.id for hit in hits] == [clip]
            assert clip in {point.clip_id for point in client.search.space(filter=condition)}
        manifest = client.labels.manifest(filter={"meta.condition": "tired"}).decode()
        assert manifest.splitlines()[1].endswith("30,tired")
        assert client.clips.list(filter={"meta.age.min": 31}).first() is None
    finally:
        client.clips.update(clip, metadata=None)


def test_values_have_types_and_give_the_answer_back(client: Kinedex, demo_service: Live) -> None:
    clip = client.clips.get(_kick(client))
    assert clip.created_at.tzinfo is not None
    assert clip.roles["hips"]
    with demo_service.client() as plain:
        assert as_json(clip) == plain.get(f"/v1/clips/{clip.id}").json()
        keyposes = plain.get(f"/v1/clips/{clip.id}/keyposes").json()
    assert client.clips.keyposes(clip.id).to_json() == keyposes


def test_searches_by_clip_file_words_and_pose(client: Kinedex, tmp_path: Path) -> None:
    clip = _kick(client)
    hits = client.search.motion(clip, limit=3, filter={"person": "ada"})
    assert [hit.rank for hit in hits] == [1, 2, 3]
    path = tmp_path / "query.bvh"
    path.write_bytes(client.clips.file(clip))
    by_file = client.search.motion(
        file=path, limit=3, filter={"person": ["ada"]}, include_self=True
    )
    assert by_file[0].clip.id == clip
    words = client.search.words(["kick nosuchword"], limit=2)
    assert words.unknown_words == ["nosuchword"]
    assert client.search.pose(clip_id=clip, time=0.5, limit=1).items
    assert client.recognize(clip).task.label == "kick"
    assert client.recognize(file=path, known_task="kick").person.label == "ada"


def test_a_search_takes_several_parts(client: Kinedex, tmp_path: Path) -> None:
    clip = _kick(client)
    examples: list[SearchExample] = [
        {"clip_id": clip},
        {"clip_id": clip, "end": 1, "against": True},
    ]
    found = client.search.parts(examples=examples, words=["kick"], limit=2)
    names = ["examples.0", "examples.1", "words.0"]
    assert [part.part for part in found[0].parts] == names
    path = tmp_path / "query.bvh"
    path.write_bytes(client.clips.file(clip))
    found = client.search.parts(examples=examples, words=["kick"], file=path, limit=2)
    assert [part.part for part in found[0].parts] == [*names[:2], "file", *names[2:]]


def test_motions_are_arrays(client: Kinedex) -> None:
    clip = _kick(client)
    motion = client.clips.motion(clip, fps=10)
    raw = client.clips.motion_array(clip, fps=10)
    assert motion.positions.shape == (len(motion.positions), len(motion.joint_names), 3)
    assert np.allclose(motion.positions, raw.positions, atol=1e-5)
    assert raw.frame_rate == motion.frame_rate == 10
    assert client.clips.descriptor(clip).motion_vector.shape == (128,)
    assert client.clips.export(clip, "bvh").startswith(b"HIERARCHY")
    assert client.clips.thumbnail(clip).startswith("<svg")


def test_signatures_and_eigenmotions_are_read(client: Kinedex) -> None:
    model = next(model for model in client.models.list().items if model.kind == "signatures")
    found = client.models.signatures(model.id, eigenmotions=2, limit=3)
    assert [one.number for one in found.eigenmotions] == [1, 2]
    assert len(found.clips) == 3
    assert np.shape(found.persons.items[0].vector) == np.shape(found.persons.singular_values)
    played = client.models.eigenmotion(model.id, 1, deviations=0, seconds=1)
    raw = client.models.eigenmotion_array(model.id, 1, deviations=0, seconds=1)
    assert np.allclose(played.positions, raw.positions, atol=1e-5)


def test_an_upload_shows_its_progress_and_its_job_can_be_awaited(
    client: Kinedex, take: DemoClip, tmp_path: Path
) -> None:
    path = tmp_path / "take.bvh"
    path.write_bytes(take.content)
    sent: list[tuple[int, int]] = []
    created = client.clips.upload(
        path,
        task="bow",
        words=["bow", "deep"],
        metadata={"age": 30},
        progress=lambda *seen: sent.append(seen),
    )
    assert created.clip.metadata == {"age": 30}
    assert sent[-1] == (len(take.content), len(take.content))
    assert created.job is not None
    states = []
    job = client.jobs.wait(
        created.job.id, timeout=300, on_progress=lambda job: states.append(job.state)
    )
    assert job.state == states[-1] == "succeeded"
    assert [job.state for job in client.jobs.follow(job.id)] == ["succeeded"]
    changed = client.clips.update(created.clip.id, person="chika", task=None)
    assert (changed.person, changed.task, changed.words) == ("chika", None, ["bow", "deep"])
    again = client.clips.upload(("again.bvh", io.BytesIO(take.content)))
    assert again.job is None
    client.clips.delete(created.clip.id)
    with pytest.raises(KinedexError, match="no clip"):
        client.clips.get(created.clip.id)


def test_an_archive_is_imported_and_its_failures_are_listed(client: Kinedex) -> None:
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w") as zipped:
        zipped.writestr("broken.bvh", "HIERARCHY\n")
    job = client.jobs.wait(client.clips.upload_archive(archive.getvalue()).job.id, timeout=300)
    (failed,) = client.jobs.files(job.id, outcome="failed")
    assert failed.error is not None
    assert failed.error.code == "unreadable"
    assert client.jobs.cancel(job.id) is None


def test_a_job_that_failed_raises_its_problem(client: Kinedex) -> None:
    created = client.clips.upload(("broken.bvh", b"HIERARCHY\nROOT hips\n"))
    assert created.job is not None
    with pytest.raises(JobFailed) as failed:
        client.jobs.wait(created.job.id, timeout=300)
    assert (failed.value.job_id, failed.value.code) == (created.job.id, "unreadable")
    assert client.jobs.wait(created.job.id, check=False).state == "failed"
    client.clips.delete(created.clip.id)


def test_a_failure_has_the_members_of_the_problem(client: Kinedex) -> None:
    with pytest.raises(KinedexError) as wrong:
        client.search.words(["kick"], limit=5000)
    assert (wrong.value.status, wrong.value.code) == (422, "bad_field")
    assert [place.location for place in wrong.value.errors] == ["body.limit"]
    with pytest.raises(KinedexError) as missing:
        client.clips.get("a b&c")
    assert (missing.value.status, missing.value.code) == (404, "clip_not_found")


def test_a_service_that_is_not_there_is_named() -> None:
    with (
        Kinedex("http://127.0.0.1:1", verify=NO_TLS, trust_env=False) as client,
        pytest.raises(Unreachable, match=r"127\.0\.0\.1:1 cannot be reached"),
    ):
        client.service.alive()


def test_lists_hits_and_segments_become_tables(client: Kinedex) -> None:
    pytest.importorskip("pandas")
    clip = _kick(client)
    clips = client.clips.list(sort="name").to_dataframe()
    assert len(clips) >= CLIPS
    assert {"id", "name", "person", "words", "created_at"} <= set(clips.columns)
    hits = client.search.motion(clip, limit=3).to_dataframe()
    assert list(hits["rank"]) == [1, 2, 3]
    assert hits["clip.id"][0] == clip or hits["clip.task"][0] == "kick"
    segments = client.clips.segments(clip)
    assert len(segments.to_dataframe()) == len(segments)
