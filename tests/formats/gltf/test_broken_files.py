"""Broken and hostile glTF files are refused with our own errors, in a short time."""

from __future__ import annotations

import copy
import struct
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import FormatNotSupported, TooLarge, Unreadable
from app.formats.gltf.reader import read_gltf
from app.formats.read import read_recording
from app.motion.skeleton.recording import Recording
from tests.cpu_time import cpu_seconds_below
from tests.formats import mutations
from tests.formats.gltf.documents import Document
from tests.formats.gltf.test_reader import CHAIN, TIMES, chain, turns


def changed(path: tuple[str | int, ...], value: object) -> bytes:
    """The leg's file with one value of the JSON object replaced."""
    document = chain()
    document.json = copy.deepcopy(document.json)
    place: Any = document.json
    for step in path[:-1]:
        place = place[step]
    place[path[-1]] = value
    return document.glb()


@pytest.mark.parametrize(
    ("path", "value", "location"),
    [
        (("nodes", 2, "children"), [0], "nodes"),
        (("nodes", 2, "children"), [1], "nodes/1"),
        (("nodes", 0, "children"), [9], "nodes/0/children"),
        (("nodes", 1, "translation"), [1, 2], "nodes/1/translation"),
        (("nodes",), 3, "nodes"),
        (("animations",), [], "animations"),
        (("accessors", 0, "count"), 10**9, "accessors/0"),
        (("accessors", 0, "count"), 14, "accessors/0"),
        (("accessors", 0, "count"), -1, "accessors/0"),
        (("accessors", 0, "bufferView"), [], "bufferViews"),
        (("accessors", 0, "type"), {}, "accessors/0"),
        (("accessors", 1, "componentType"), 1, "accessors/1"),
        (("bufferViews", 1, "byteOffset"), 10**6, "accessors/1"),
        (("animations", 0, "samplers", 0, "input"), None, "accessors"),
        (("animations", 0, "samplers", 0, "output"), 0, "animations/0"),
        (("animations", 0, "samplers", 0, "interpolation"), "CURVE", "animations/0"),
        (("animations", 0, "channels", 0, "sampler"), 7, "animations/0"),
    ],
)
def test_the_error_names_the_object(
    path: tuple[str | int, ...], value: object, location: str
) -> None:
    with pytest.raises((Unreadable, TooLarge)) as caught:
        read_gltf(changed(path, value))
    assert caught.value.places[0].location == location


def test_files_of_other_versions_and_compressed_ones_are_refused() -> None:
    with pytest.raises(FormatNotSupported, match="glTF 1"):
        read_recording(b"glTF" + struct.pack("<I", 1) + bytes(40))
    packed = changed(("bufferViews", 1, "extensions"), {"EXT_meshopt_compression": {}})
    with pytest.raises(FormatNotSupported) as caught:
        read_recording(packed)
    assert "EXT_meshopt_compression" in caught.value.places[0].message


def test_deep_and_wide_files_are_refused_quickly() -> None:
    deep = b'{"asset":' * 2 + b'{"nodes":[' * 200_000
    with cpu_seconds_below(1.0), pytest.raises(Unreadable):
        read_gltf(deep)
    count = 30_000
    nodes = [{"children": [index + 1]} for index in range(count)] + [{}]
    document = Document(nodes)
    value = document.array(turns().astype("<f4"))
    document.animate([(n, "rotation", document.array(TIMES), value) for n in (0, count)])
    document.json["skins"] = [{"joints": [0, count]}]
    with cpu_seconds_below(3.0), pytest.raises(TooLarge):
        read_gltf(document.glb())


def test_a_far_key_does_not_add_hours() -> None:
    document = Document([dict(node) for node in CHAIN])
    times = document.array(np.array([[0.0], [0.04], [1e8]], "<f4"))
    document.animate([(0, "rotation", times, document.array(turns(0, 3).astype("<f4")))])
    with cpu_seconds_below(1.0), pytest.raises(TooLarge):
        read_gltf(document.glb())


SMALL = chain().glb()
SMALL_JSON = chain().gltf()


def read_broken(seed: int) -> Recording:
    pieces = (*mutations.PIECES, b"null", b"-1", b"[]", b"{}", b"1e400", b"99999999999999999999")
    return read_gltf(mutations.mutated(SMALL if seed % 3 else SMALL_JSON, seed, pieces))


def test_damaged_files_raise_only_our_own_errors() -> None:
    assert 30 < mutations.check_broken(read_broken, range(600)) < 590


@pytest.mark.slow
def test_ten_thousand_damaged_files_raise_only_our_own_errors() -> None:
    mutations.check_broken(read_broken, range(10_000))


JSON = st.recursive(
    st.none() | st.booleans() | st.integers(-2, 40) | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner),
    max_leaves=5,
)


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_any_value_anywhere_is_read_or_refused(data: st.DataObject) -> None:
    document = chain()
    # The lists of the example are shared by all tests.
    document.json = copy.deepcopy(document.json)
    place: Any = document.json
    steps: list[str | int] = []
    while isinstance(place, (dict, list)) and place and len(steps) < 5:
        keys = list(place) if isinstance(place, dict) else list(range(len(place)))
        steps.append(data.draw(st.sampled_from(keys)))
        parent, place = place, place[steps[-1]]
        if data.draw(st.booleans()):
            break
    parent[steps[-1]] = data.draw(JSON)
    try:
        recording = read_gltf(document.glb())
    except (Unreadable, TooLarge, FormatNotSupported):
        return
    assert np.isfinite(recording.positions).all()
