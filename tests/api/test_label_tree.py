"""The tree of labels over HTTP and by the Python client."""

from __future__ import annotations

from typing import Any

import httpx2

from kinedex import Kinedex
from tests.live import Live


def test_the_tree_is_read_changed_and_used(
    demo_service: Live, demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    demo.patch(f"/v1/clips/{walk['id']}", json={"task": "slow sad walk"})
    with Kinedex(demo_service.url) as client:
        nodes = {node.name: node for node in client.labels.tree().items}
        node = nodes["slow_sad_walk"]
        assert (node.parent, node.because, node.tasks, node.tasks_below) == ("walk", "phrase", 1, 1)
        walks = demo.get("/v1/clips", params={"task": "walk"}).json()["total"]
        assert nodes["walk"].tasks_below == walks
        exact = demo.get("/v1/clips?task==walk").json()["total"]
        assert exact == walks - 1
        sent = {"clip_id": walk["id"], "filter": {"task": "=slow sad walk"}, "include_self": True}
        hits = demo.post("/v1/search/motion", json=sent).json()["items"]
        assert [hit["clip"]["id"] for hit in hits] == [walk["id"]]
        changed = client.labels.put_tree({"slow sad walk": None})
        assert {n.name: n.parent for n in changed.items}["slow_sad_walk"] is None
        assert demo.get("/v1/clips", params={"task": "walk"}).json()["total"] == exact
        client.labels.put_tree({})
    circle = demo.put("/v1/labels/tree", json={"parents": {"a": "b", "b": "a"}})
    assert circle.status_code == 422
    demo.patch(f"/v1/clips/{walk['id']}", json={"task": "walk"})
