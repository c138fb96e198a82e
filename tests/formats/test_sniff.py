"""Formats are recognized by their first bytes."""

from __future__ import annotations

import io
import pickle
import zipfile
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import EmptyFile, FormatNotSupported, UnknownFormat
from app.formats.read import READERS, read_recording
from app.formats.sniff import HEAD_BYTES, TAIL_BYTES, sniff
from app.kinedex_error import KinedexError
from tests.formats.samples import bvh
from tests.real_clips import manifest, real_clips


def zipped(*names: str) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name in names:
            archive.writestr(name, "x")
    return buffer.getvalue()


def npy() -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, np.zeros(3))
    return buffer.getvalue()


SAMPLES = [
    ("bvh", bvh()),
    ("bvh", b"\xef\xbb\xbf\r\n  hierarchy\r\nROOT"),
    ("asf", b"# AST/ASF file\n:version 1.10\n"),
    ("amc", b"#!OML:ASF\n:FULLY-SPECIFIED\n:DEGREES\n1\n"),
    ("fbx", b"Kaydara FBX Binary  \x00\x1a\x00"),
    ("fbx", b"; FBX 7.3.0 project file\n"),
    ("fbx", b"; FBX 6.1.0 project file\n"),
    ("c3d", b"\x02\x50" + bytes(510)),
    ("trc", b"PathFileType\t4\t(X/Y/Z)\twalk.trc\n"),
    ("csv", b"Format Version,1.23,Take Name,Walk\n"),
    ("csv", b"Trajectories\r\n100\r\n"),
    ("csv", b"Devices,,,\r\n1000,,,\r\n"),
    ("tsv", b"NO_OF_FRAMES\t10\n"),
    ("glb", b"glTF\2\0\0\0"),
    ("gltf", b'{"asset": {"version": "2.0"}, "nodes": []}'),
    ("json", b'{"people": [{"pose_keypoints_3d": []}]}'),
    ("json", b"[[[1, 2, 3]]]"),
    ("mvnx", b'<?xml version="1.0"?>\n<mvnx version="4">'),
    ("npy", npy()),
    ("npz", zipped("poses.npy")),
    ("npz", zipped("gender.npy", "mocap_framerate.npy", "poses.npy")),
    ("npz", zipped("Joint Positions.npy")),
    ("npz", zipped("poses.npy")[:40]),
    ("zip", zipped("clip.bvh")),
    ("zip", zipped("walk_01.npy", "walk_02.npy")),
    ("zip", zipped("positions.npy", "clip.bvh")),
    ("zip", zipped("set/positions.npy")),
    ("zip", zipped()),
    ("zip", zipped("walk_01.npy")[:40]),
]


@pytest.mark.parametrize(("name", "content"), SAMPLES, ids=lambda _: "")
def test_each_format_is_recognized(name: str, content: bytes) -> None:
    assert sniff(content) == name


def test_the_first_and_the_last_bytes_are_enough() -> None:
    buffer = io.BytesIO()
    np.savez(buffer, gender=np.zeros(30_000), poses=np.zeros(30_000))
    content = buffer.getvalue()
    assert len(content) > 3 * TAIL_BYTES
    assert sniff(content[:HEAD_BYTES] + content[-TAIL_BYTES:]) == sniff(content) == "npz"


@pytest.mark.parametrize("content", [b"", b" \r\n\t"])
def test_empty_content_is_refused(content: bytes) -> None:
    with pytest.raises(EmptyFile):
        sniff(content)


@pytest.mark.parametrize(
    "content", [b"hello", b"%PDF-1.7", bytes(1000), b"\x89PNG", b"a HIERARCHY"]
)
def test_other_content_is_refused(content: bytes) -> None:
    with pytest.raises(UnknownFormat):
        sniff(content)


@pytest.mark.parametrize(
    ("content", "word", "advice"),
    [
        (pickle.dumps({"poses": [1]}), "pickle", "numpy.savez"),
        (pickle.dumps([1], protocol=0), "pickle", "numpy.savez"),
        (b"%YAML 1.1\n%TAG !u! tag:unity3d.com,2011:\n--- !u!74 &7400000", "Unity", "FBX"),
        (b"BLENDER-v300", "Blender", "BVH"),
        (b"#usda 1.0\n", "USD", "Blender"),
        (b"PXR-USDC" + bytes(20), "USD", "Blender"),
        (b"Vocaloid Motion Data 0002" + bytes(30), "MMD", "Blender"),
        (b'<?xml version="1.0"?>\n<!-- x --><COLLADA xmlns="x">', "COLLADA", "GLB"),
        (b"MATLAB 5.0 MAT-file, Platform: GLNXA64", "MATLAB", "scipy.io.loadmat"),
        (b"\x89HDF\r\n\x1a\n", "HDF5", "h5py"),
        (b"Coordinates\nversion=1\nnRows=9\nendheader\ntime\thip", "OpenSim", "TRC"),
        (b"version https://git-lfs.github.com/spec/v1\n", "Git LFS", "git lfs pull"),
        (b"\x1f\x8b\x08", "archive", "ZIP"),
    ],
)
def test_other_formats_are_named_with_the_way_to_convert_them(
    content: bytes, word: str, advice: str
) -> None:
    with pytest.raises(FormatNotSupported, match=word) as caught:
        sniff(content)
    assert advice in caught.value.detail
    for name in ("BVH", "TRC", "GLB", "MVNX"):
        assert name in caught.value.detail


def test_the_error_for_unknown_content_lists_the_formats() -> None:
    with pytest.raises(UnknownFormat, match="BVH, ASF with AMC, C3D, TRC"):
        sniff(b"hello")


@pytest.mark.parametrize("content", [b'{"a": 1}', b"<html>", b"<svg>", b"{", b"[]x"])
def test_other_json_and_xml_is_refused(content: bytes) -> None:
    with pytest.raises(KinedexError):
        read_recording(content)


@given(st.binary(max_size=100))
def test_noise_raises_only_our_own_errors(noise: bytes) -> None:
    with suppress(KinedexError):
        read_recording(noise)


def test_formats_without_a_reader_are_named() -> None:
    for name, content in SAMPLES:
        if name not in READERS:
            with pytest.raises(FormatNotSupported, match=name.upper()):
                read_recording(content)


def test_read_recording_finds_the_reader() -> None:
    assert read_recording(bvh()).format == "bvh"


def test_real_files_are_recognized_by_their_content() -> None:
    for row in manifest()[::10] + [r for r in manifest() if not r["path"].endswith(".bvh")]:
        content = (real_clips() / row["path"]).read_bytes()
        assert sniff(content) == row["path"].rsplit(".")[-1]
