"""The metrics tell an operator what happens in the service, in the format of Prometheus."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import httpx2
import yaml
from prometheus_client import Metric
from prometheus_client.parser import text_string_to_metric_families

from tests.live import NET_S, Live, wait_until

DOCKER = Path(__file__).resolve().parents[2] / "docker"
_NAME = re.compile(r"\b(?:kinedex|http|process)_\w+")
_SUFFIXES = re.compile(r"_(?:sum|count|total|bucket|created)$")


def families(client: httpx2.Client) -> dict[str, Metric]:
    """The metrics of a service by name."""
    answer = client.get("/metrics")
    assert answer.status_code == 200
    assert answer.headers["content-type"].startswith("text/plain")
    return {family.name: family for family in text_string_to_metric_families(answer.text)}


def values(metric: Metric, suffix: str = "") -> dict[tuple[str, ...], float]:
    """The values of the samples of a metric by the values of their labels."""
    return {
        tuple(sample.labels.values()): sample.value
        for sample in metric.samples
        if sample.name == metric.name + suffix
    }


def ready_clips(client: httpx2.Client) -> int:
    """The number of ready clips of a small library."""
    return len(client.get("/v1/clips", params={"state": "ready", "limit": 100}).json()["items"])


def test_the_state_of_a_library_is_shown(demo_service: Live) -> None:
    with demo_service.client() as client:
        wait_until(lambda: values(families(client)["kinedex_workers"])[("alive",)], NET_S)
        found = families(client)
        clips = ready_clips(client)
        # The index catches up at a search; before, it may hold clips that other tests deleted.
        (any_clip,) = client.get("/v1/clips", params={"state": "ready", "limit": 1}).json()["items"]
        assert client.post("/v1/search/motion", json={"clip_id": any_clip["id"]}).is_success
        wait_until(lambda: values(families(client)["kinedex_index_clips"])[()] == clips, NET_S)
    assert values(found["kinedex_clips"])[("ready",)] == clips > 0
    index = values(found["kinedex_index_version"])[()]
    assert 0 <= index <= values(found["kinedex_library_version"])[()]
    jobs = values(found["kinedex_jobs"])
    assert len(jobs) == 20
    assert jobs["ingest", "succeeded"] >= clips
    assert values(found["kinedex_oldest_job_age_seconds"])["ingest", "queued"] == 0.0
    assert values(found["kinedex_workers"]) == {("alive",): 1.0, ("silent",): 0.0}
    assert values(found["kinedex_workers_resident_memory_bytes"])[()] > 1e6
    assert values(found["process_resident_memory_bytes"])[()] > 1e6
    assert {kind for (kind,) in values(found["kinedex_model_age_seconds"])} >= {"words"}
    assert set(values(found["kinedex_disk_free_bytes"])) == {("database",), ("files",)}
    assert values(found["kinedex_database_bytes"])[()] > 0
    assert values(found["kinedex_database_up"]) == {(): 1.0}


def test_the_time_of_each_stage_is_summed(demo_service: Live) -> None:
    with demo_service.client() as client:
        stages = families(client)["kinedex_analysis_stage_seconds"]
        clips = ready_clips(client)
    counts, seconds = values(stages, "_count"), values(stages, "_sum")
    assert set(counts) == {
        (stage,)
        for stage in (
            "read",
            "canonicalize",
            "listen",
            "describe",
            "symbol",
            "rhythm",
            "keyposes",
            "measures",
        )
    }
    assert all(count >= clips for count in counts.values())
    assert seconds["symbol",] > 0


def test_a_library_without_a_worker_says_so(idle: httpx2.Client) -> None:
    found = families(idle)
    assert values(found["kinedex_workers"]) == {("alive",): 0.0, ("silent",): 0.0}


def test_names_and_texts_follow_the_conventions(demo: httpx2.Client) -> None:
    for name, family in families(demo).items():
        if name.startswith("kinedex_"):
            assert family.documentation.endswith("."), name
            assert family.type in {"gauge", "summary"}
            assert "_ms" not in name
            assert not name.endswith("_total")


def test_every_metric_is_in_the_documentation(demo: httpx2.Client) -> None:
    shown = {name for name in families(demo) if name.startswith("kinedex_")}
    table = (DOCKER / "README.md").read_text()
    documented = set(re.findall(r"^\| `(kinedex_\w+)", table, re.MULTILINE))
    # The demo library has no failures.
    assert shown | {"kinedex_failed_clips", "kinedex_failed_jobs"} == documented


def test_the_rules_and_the_dashboard_use_metrics_that_exist(demo: httpx2.Client) -> None:
    names = set(families(demo)) | {"kinedex_failed_clips", "kinedex_failed_jobs"}
    rules = yaml.safe_load((DOCKER / "alerts.yaml").read_text())
    dashboard = json.loads((DOCKER / "grafana-dashboard.json").read_text())
    expressions = [
        *(rule["expr"] for group in rules["groups"] for rule in group["rules"]),
        *(target["expr"] for panel in dashboard["panels"] for target in panel["targets"]),
    ]
    assert len(expressions) > 10
    for expression in expressions:
        used = {_SUFFIXES.sub("", name) for name in _NAME.findall(expression)}
        assert used, expression
        assert used <= names, expression


def test_every_rule_says_what_is_wrong() -> None:
    rules: dict[str, Any] = yaml.safe_load((DOCKER / "alerts.yaml").read_text())
    for group in rules["groups"]:
        for rule in group["rules"]:
            assert set(rule) == {"alert", "expr", "for", "labels", "annotations"}
            assert rule["labels"]["severity"] in {"warning", "critical"}
            assert rule["annotations"]["summary"]
