"""Audio files of each format give the same samples; damaged and hostile ones are refused."""

from __future__ import annotations

import io
import sys

import numpy as np
import pytest
import soundfile

from app.demo.dances.wav import write_wav
from app.errors import BadContent, EmptyFile, ExtraNeeded, TooLarge, UnknownFormat, Unreadable
from app.formats.audio import reader as audio
from app.formats.audio.reader import read_audio, sniff_audio
from tests.formats.mutations import mutated

RATE = 22050
TONE = 0.5 * np.sin(2 * np.pi * 440 * np.arange(2 * RATE) / RATE)


def encoded(
    samples: np.ndarray = TONE, format: str = "WAV", rate: int = RATE, **options: str
) -> bytes:
    file = io.BytesIO()
    soundfile.write(file, samples, rate, format=format, **options)
    return file.getvalue()


@pytest.mark.parametrize("format", ["WAV", "FLAC", "OGG", "MP3"])
def test_every_format_gives_the_samples(format: str) -> None:
    sound = read_audio(encoded(format=format))
    assert sound.format == format.lower()
    assert sound.rate == RATE
    assert sound.samples.dtype == np.float32
    assert sound.duration == pytest.approx(2.0, abs=0.06)  # MP3 comes in whole frames
    spectrum = np.abs(np.fft.rfft(sound.samples))
    assert spectrum.argmax() / sound.duration == pytest.approx(440.0, rel=0.03)
    assert np.abs(sound.samples).max() == pytest.approx(0.5, abs=0.03)


@pytest.mark.parametrize("subtype", ["PCM_U8", "PCM_16", "PCM_24", "FLOAT", "DOUBLE"])
def test_wav_of_every_depth(subtype: str) -> None:
    np.testing.assert_allclose(read_audio(encoded(subtype=subtype)).samples, TONE, atol=0.01)


def test_a_wav_file_of_our_own_is_read() -> None:
    np.testing.assert_allclose(read_audio(write_wav(TONE, RATE)).samples, TONE, atol=1e-4)


def test_channels_are_mixed_to_mono() -> None:
    stereo = np.stack([TONE, -TONE, 3 * TONE / 2, TONE / 2], axis=1)
    np.testing.assert_allclose(read_audio(encoded(stereo)).samples, TONE / 2, atol=1e-4)


@pytest.mark.parametrize(("rate", "result_rate"), [(8000, 8000), (44100, 22050), (96000, 24000)])
def test_fast_recordings_are_decimated(rate: int, result_rate: int) -> None:
    tone = np.sin(2 * np.pi * 440 * np.arange(rate) / rate)
    sound = read_audio(encoded(tone, rate=rate, subtype="FLOAT"))
    assert sound.rate == result_rate
    assert sound.duration == pytest.approx(1.0, abs=0.01)
    assert np.abs(np.fft.rfft(sound.samples)).argmax() == pytest.approx(440, abs=2)


@pytest.mark.parametrize(
    ("head", "failure"),
    [
        (b"", EmptyFile),
        (b"RIFF\x00\x00\x00\x00AVI ", UnknownFormat),
        (b"HIERARCHY\nROOT", UnknownFormat),
        (b"\xff\xd8\xff\xe0\x00\x10JFIF", UnknownFormat),
        (b"\xff", UnknownFormat),
    ],
)
def test_other_files_are_refused(head: bytes, failure: type[BadContent]) -> None:
    with pytest.raises(failure):
        sniff_audio(head)
    with pytest.raises(failure):
        read_audio(head)


def test_an_mp3_file_without_a_tag_is_recognized() -> None:
    content = encoded(format="MP3", rate=44100)
    assert sniff_audio(content[content.index(b"\xff\xfb") :][:12]) == "mp3"


def test_samples_of_nan_are_refused() -> None:
    broken = TONE.copy()
    broken[100] = np.nan
    with pytest.raises(Unreadable, match="not numbers"):
        read_audio(encoded(broken, subtype="FLOAT"))


def test_a_recording_without_samples_is_refused() -> None:
    with pytest.raises(Unreadable, match="no sound"):
        read_audio(encoded(TONE[:0]))


def test_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(TooLarge, match="40 channels"):
        read_audio(encoded(np.zeros((10, 40))))
    with pytest.raises(Unreadable, match="1000 Hz"):
        read_audio(encoded(rate=1000))
    monkeypatch.setattr(audio, "MAX_SECONDS", 1.5)
    with pytest.raises(TooLarge, match="longer than"):
        read_audio(encoded(format="FLAC"))


@pytest.mark.parametrize("format", ["WAV", "FLAC", "OGG", "MP3"])
def test_damaged_files_are_read_or_refused(format: str) -> None:
    whole = encoded(TONE[:4000], format=format)
    refused = 0
    for seed in range(60):
        try:
            sound = read_audio(mutated(whole, seed))
        except (BadContent, TooLarge):
            refused += 1
            continue
        assert np.isfinite(sound.samples).all()
    assert 0 < refused < 60


def _stated(size: int) -> bytes:
    """A WAV file whose header states this size of its samples."""
    whole = bytearray(encoded())
    at = whole.index(b"data") + 4
    whole[at : at + 4] = size.to_bytes(4, "little")
    return bytes(whole)


@pytest.mark.parametrize("format", ["WAV", "WAVEX", "RF64"])
def test_a_cut_off_wav_file_reports_its_declared_and_its_real_size(format: str) -> None:
    whole = encoded(format=format)
    assert read_audio(whole).missing is None
    for length in (2000, len(whole) - 2):
        cut = read_audio(whole[:length])
        assert cut.missing == f"its header promises {len(whole)} bytes, {length} are there"
        np.testing.assert_allclose(cut.samples, TONE[: len(cut.samples)], atol=1e-3)
        assert cut.duration == pytest.approx(length / 2 / RATE, abs=0.01)


@pytest.mark.parametrize("size", [0x7FFFFFFF, 0x80000000, 0xFFFFFFFF])
def test_a_wav_file_written_as_a_stream_is_complete(size: int) -> None:
    streamed = read_audio(_stated(size))
    assert streamed.missing is None
    assert streamed.duration == pytest.approx(2.0, abs=0.01)


@pytest.mark.parametrize("format", ["FLAC", "MP3"])
def test_the_existing_part_of_a_cut_off_recording_is_decoded(format: str) -> None:
    tone = np.tile(TONE, 10)
    whole = encoded(tone, format=format)
    cut = read_audio(whole[: len(whole) * 2 // 3])
    assert 8 < cut.duration < 15
    assert cut.missing is not None
    assert cut.missing.startswith("its header promises 20.00 s, 1")
    assert read_audio(whole).missing is None


def test_without_soundfile_the_error_names_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "soundfile", None)
    with pytest.raises(ExtraNeeded, match=r"pip install soundfile"):
        read_audio(encoded())
