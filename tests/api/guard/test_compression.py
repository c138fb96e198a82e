"""Compressed answers: the same content, only if the client accepts it and it is worth it."""

from __future__ import annotations

import gzip

import httpx2
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.api.guard.compression import accepted_encodings, zstd
from tests.live import Live

DECOMPRESS = {"gzip": gzip.decompress, "zstd": zstd.decompress}
TEXTS = ["/v1/clips?limit=100", "/openapi.json", "{clip}/motion", "{clip}/animation.svg"]


def raw(live: Live, path: str, accept: str) -> tuple[httpx2.Headers, bytes]:
    """The headers and the body as they were sent."""
    with live.client() as client:
        clip = client.get("/v1/clips?state=ready").json()["items"][0]["id"]
        url = path.format(clip=f"/v1/clips/{clip}")
        with client.stream("GET", url, headers={"Accept-Encoding": accept}) as answer:
            assert answer.status_code == 200
            return answer.headers, b"".join(answer.iter_raw())


@pytest.mark.parametrize("path", TEXTS)
@pytest.mark.parametrize("encoding", ["gzip", "zstd"])
def test_text_is_compressed(demo_service: Live, path: str, encoding: str) -> None:
    plain_headers, plain = raw(demo_service, path, "identity")
    assert "content-encoding" not in plain_headers
    headers, sent = raw(demo_service, path, encoding)
    assert headers["content-encoding"] == encoding
    assert "Accept-Encoding" in headers["vary"]
    assert DECOMPRESS[encoding](sent) == plain
    assert len(sent) < len(plain) / 2


@pytest.mark.parametrize("path", ["/livez", "{clip}/file", "{clip}/export?format=npz"])
def test_small_answers_octets_and_archives_are_sent_as_they_are(
    demo_service: Live, path: str
) -> None:
    headers, sent = raw(demo_service, path, "gzip, zstd")
    assert "content-encoding" not in headers
    assert sent


def test_the_better_of_two_accepted_encodings_is_used(demo_service: Live) -> None:
    for accept, used in [
        ("gzip, deflate, br, zstd", "zstd"),
        ("gzip, zstd;q=0", "gzip"),
        ("br", None),
        ("gzip;q=0", None),
    ]:
        assert raw(demo_service, "/openapi.json", accept)[0].get("content-encoding") == used


@given(st.text())
def test_any_header_is_read(header: str) -> None:
    assert all(name == name.strip() for name in accepted_encodings(header))


WEIGHTS = st.sampled_from(["", ";q=1", ";q=0.5", "; q=0", ";q=0.000"])


@given(st.dictionaries(st.sampled_from(["gzip", "zstd", "br"]), WEIGHTS))
def test_encodings_with_a_weight_of_zero_are_not_accepted(weights: dict[str, str]) -> None:
    header = ", ".join(name + weight for name, weight in weights.items())
    wanted = {name for name, weight in weights.items() if not weight.endswith(("=0", "=0.000"))}
    assert accepted_encodings(header) - {""} == wanted
