"""Text files and files of version 6 are read as binary files of version 7 are."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.errors import BadField, Unreadable
from app.formats.fbx.reader import read_fbx
from app.formats.read import read_recording
from app.formats.sniff import sniff
from app.motion.skeleton.recording import Recording
from tests.cpu_time import cpu_seconds_below
from tests.formats import mutations
from tests.formats.fbx.files import (
    AUTO,
    CONSTANT,
    CUBIC,
    NEXT,
    USER,
    Bone,
    Curve,
    Record,
    Take,
    document,
    fbx,
    packed_weights,
    scene,
)
from tests.formats.fbx.other_forms import legacy_scene, text_document
from tests.formats.fbx.takes import CHAIN, SWAY, curves, expected

SETTINGS = {"TimeMode": 6}
TEXT = text_document(scene(CHAIN, [Take("walk", [curves(SWAY)])], settings=SETTINGS))
OLD = legacy_scene(CHAIN, [("walk", curves(SWAY))])


def same(one: Recording, other: Recording) -> bool:
    return (
        one.skeleton.names == other.skeleton.names
        and one.frame_rate == other.frame_rate
        and bool(np.allclose(one.positions, other.positions, atol=1e-3))
    )


@pytest.mark.parametrize(
    "content", [TEXT, text_document(OLD, 6100), document(OLD, 6100)], ids=["text 7", "text 6", "6"]
)
def test_the_motion_is_that_of_a_binary_file(content: bytes) -> None:
    assert sniff(content) == "fbx"
    recording = read_recording(content)
    assert (recording.format, recording.frame_rate) == ("fbx", 30)
    assert np.allclose(recording.positions, expected(CHAIN), atol=1e-3)
    assert same(recording, read_fbx(fbx(CHAIN, [Take("walk", [curves(SWAY)])], settings=SETTINGS)))


@pytest.mark.parametrize("newline", [b"\r\n", b"\r"])
def test_other_ends_of_lines(newline: bytes) -> None:
    assert same(read_fbx(TEXT.replace(b"\n", newline)), read_fbx(TEXT))


def test_names_with_quotes_and_colons() -> None:
    bones = [Bone('rig:a "b"', -1), *CHAIN[1:]]
    content = text_document(scene(bones, [Take("t", [curves(SWAY)])]))
    assert read_fbx(content).skeleton.names[0] == 'rig:a "b"'


@pytest.mark.parametrize("version", [7100, 7400])
def test_weights_of_tangents_in_text(version: int) -> None:
    data = [(30.0, -10.0, packed_weights(0.7, 0.2), 0.0)] * 2
    weighted = CUBIC | USER | 0x3000000
    turn = {(1, "Lcl Rotation"): {"Z": Curve([0, 0.5], [10, 50], weighted, data)}}
    records = scene(CHAIN, [Take("t", [turn])], settings=SETTINGS)
    assert same(read_fbx(text_document(records, version)), read_fbx(document(records)))


@pytest.mark.parametrize("flags", [CONSTANT, NEXT, CUBIC | USER])
def test_ways_between_keys_of_version_6(flags: int) -> None:
    data = [(30.0, -10.0, 0.0, 0.0)] * 3
    turn = {(1, "Lcl Rotation"): {"Z": Curve([0, 0.2, 0.5], [10, 50, 20], flags, data)}}
    new = read_fbx(fbx(CHAIN, [Take("t", [turn])], settings=SETTINGS))
    for content in (text_document(legacy_scene(CHAIN, [("t", turn)]), 6100),
                    document(legacy_scene(CHAIN, [("t", turn)]), 6100)):  # fmt: skip
        assert same(read_fbx(content), new)


def with_keys(*entries: bytes) -> bytes:
    """A text file of version 6 in which the hips turn by the given list of keys."""
    turn = {(1, "Lcl Rotation"): {"Z": Curve([0, 0.5], [10, 50], CONSTANT)}}
    content = text_document(legacy_scene(CHAIN, [("t", turn)]), 6100)
    start = content.index(b"Key: ") + 5
    end = content.index(b"}", start)
    return content[:start] + b",".join(entries) + b"\n" + content[end:]


def test_weights_and_automatic_tangents_of_version_6() -> None:
    weighted = with_keys(b"0,10,U,s,30,-10,a,0.7,0.2", b"23093079000,50,U,s,0,0,n")
    data = [(30.0, -10.0, packed_weights(0.7, 0.2), 0.0), (0.0, 0.0, 0.0, 0.0)]
    flags = [CUBIC | USER | 0x3000000, CUBIC | USER]
    turn = {(1, "Lcl Rotation"): {"Z": Curve([0, 0.5], [10, 50], flags, data)}}
    assert same(read_fbx(weighted), read_fbx(fbx(CHAIN, [Take("t", [turn])], settings=SETTINGS)))
    automatic = with_keys(b"0,10,U,a,n", b"11546539500,50,U,a,n", b"23093079000,20,U,a,n")
    smooth = {
        (1, "Lcl Rotation"): {"Z": Curve([0, 0.25, 0.5], [10, 50, 20], CUBIC | AUTO | 0x6000)}
    }
    assert same(read_fbx(automatic), read_fbx(fbx(CHAIN, [Take("t", [smooth])], settings=SETTINGS)))


@pytest.mark.parametrize(
    "entries",
    [b"0,10,X", b"0,10,U,s,30", b"0", b"0,10,U,z,n", b"L,0,10", b"1e200,1,L", b"0,10,C,q"],
)
def test_the_error_for_broken_keys_names_the_take(entries: bytes) -> None:
    with pytest.raises(Unreadable) as caught:
        read_fbx(with_keys(entries))
    assert caught.value.places[0].location.startswith("node Takes, byte")


@pytest.mark.parametrize("version", [b"1e999", b"nan", b"x", b""])
def test_a_wrong_version_of_keys_is_read_as_the_usual_one(version: bytes) -> None:
    content = text_document(OLD, 6100)
    assert same(
        read_fbx(content.replace(b"KeyVer: 4005", b"KeyVer: " + version)), read_fbx(content)
    )


def test_takes_and_rates_of_version_6() -> None:
    short = {(0, "Lcl Translation"): {"X": Curve([0, 0.1], [0, 9])}}
    records = legacy_scene(CHAIN, [("step", short), ("walk", curves(SWAY, 24))], frame_rate="24")
    content = text_document(records, 6100)
    recording = read_fbx(content)
    assert recording.frame_rate == 24
    assert "step, walk" in recording.cautions[0].detail
    assert len(read_fbx(content, "step").positions) < len(recording.positions)
    with pytest.raises(BadField, match="step, walk"):
        read_fbx(content, "run")
    timed = legacy_scene(CHAIN, [("walk", curves(SWAY, 60))], {"TimeMode": 3, "UpAxis": 1})
    assert read_fbx(document(timed, 6100)).frame_rate == 60


@settings(max_examples=40, deadline=None)
@given(st.lists(st.floats(-1e6, 1e6, width=32), min_size=2, max_size=30))
def test_every_number_of_a_text_file_is_read(values: list[float]) -> None:
    times = [index / 30 for index in range(len(values))]
    move = {(0, "Lcl Translation"): {"X": Curve(times, values)}}
    records = scene(CHAIN, [Take("t", [move])], settings=SETTINGS)
    text, binary = read_fbx(text_document(records)), read_fbx(document(records))
    assert np.array_equal(text.positions, binary.positions)


SEEDS = (TEXT, text_document(OLD, 6100), document(OLD, 6100))


def read_broken(seed: int) -> Recording:
    pieces = (*mutations.PIECES, b"{", b"}", b'"', b"::", b",U,s,", b"Model: ", b"*9")
    return read_fbx(mutations.mutated(SEEDS[seed % 3], seed, pieces))


def test_damaged_files_raise_only_our_own_errors() -> None:
    assert 30 < mutations.check_broken(read_broken, range(450)) < 440


@pytest.mark.slow
def test_ten_thousand_damaged_files_raise_only_our_own_errors() -> None:
    mutations.check_broken(read_broken, range(10_000))


def test_deep_and_unclosed_text_is_refused_quickly() -> None:
    head = b"; FBX 7.4.0 project file\nFBXHeaderExtension: {\nFBXVersion: 7400\n}\n"
    for body in (b"a: {" * 100_000, b"}" * 100_000, b'"' * 100_001, b"x" * 1_000_000, b"a:" * 99):
        with cpu_seconds_below(3.0), pytest.raises(Unreadable):
            read_fbx(head + body)


def test_records_that_are_not_needed_are_only_skipped() -> None:
    numbers = b",".join(b"0.125" for _ in range(300_000))
    mesh = b'Geometry: 5, "Geometry::", "Mesh" {\nVertices: *300000 {\na: ' + numbers + b"\n}\n}\n"
    content = TEXT.replace(b"Objects:  {\n", b"Objects:  {\n" + mesh)
    with cpu_seconds_below(1.0):
        assert same(read_fbx(content), read_fbx(TEXT))


def test_a_scene_without_takes_is_refused() -> None:
    records = [Record("FBXHeaderExtension"), Record("Objects", [], OLD[1].children)]
    with pytest.raises(Unreadable, match="animation"):
        read_fbx(document(records, 6100))
