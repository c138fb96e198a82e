"""Reads audio recordings: WAV, FLAC, OGG and MP3 to mono samples, by libsndfile (soundfile).

Each block is decoded, mixed to mono and decimated before the next one. So a small file that
decompresses to hours costs no more than the limit allows. soundfile is in the extra `audio`.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.errors import EmptyFile, ExtraNeeded, Place, TooLarge, UnknownFormat, Unreadable
from app.formats.audio.riff import promised_bytes
from app.numerics.arrays import FloatArray

FORMATS = "WAV, FLAC, OGG or MP3"
HEAD_BYTES = 12
"""The first bytes of a file, which show its format."""

SAMPLE_RATES = (2000, 400_000)
"""Hz: the smallest and the largest sample rate of a recording."""

ENOUGH = 22_050
"""Hz. In faster recordings neighboring samples are averaged; the result is not below this rate."""

MAX_SECONDS = 1800.0
MAX_DECLARED_SECONDS = 24 * 3600.0
"""Seconds. If a header gives a longer duration, it is not known and is ignored."""
MIN_SHARE = 0.95
"""The share of the declared duration that must be there. That of MP3 files is only an estimate."""

MAX_CHANNELS = 32
BLOCK_FRAMES = 65_536


@dataclass(frozen=True, slots=True)
class Sound:
    """samples: (n,) float32 mono, full scale 1; rate: Hz of `samples`; format: of the file;
    missing: of a file that was cut off or damaged, what it promises and what is there."""

    samples: FloatArray
    rate: float
    format: str
    missing: str | None = None

    @property
    def duration(self) -> float:
        """Seconds."""
        return len(self.samples) / self.rate


def sniff_audio(head: bytes) -> str:
    """The format of a recording by its first HEAD_BYTES: "wav", "flac", "ogg" or "mp3".

    Raises EmptyFile, UnknownFormat.
    """
    if not head:
        raise EmptyFile("The recording is empty.")
    if head[:4] in (b"RIFF", b"RIFX", b"RF64") and head[8:12] == b"WAVE":
        return "wav"
    for magic, format in ((b"fLaC", "flac"), (b"OggS", "ogg"), (b"ID3", "mp3")):
        if head.startswith(magic):
            return format
    # MPEG audio, layer 3: eleven set bits, no reserved version, layer code 01.
    if len(head) > 1 and head[0] == 0xFF and head[1] & 0xE6 == 0xE2 and head[1] & 0x18 != 0x08:
        return "mp3"
    raise UnknownFormat(f"The recording must be {FORMATS}.")


def read_audio(content: bytes) -> Sound:
    """Decode a recording; of a file that was cut off, decode the part that is there.

    Raises EmptyFile, UnknownFormat, Unreadable, TooLarge beyond MAX_SECONDS or MAX_CHANNELS,
    and ExtraNeeded where soundfile is not installed.
    """
    format = sniff_audio(content[:HEAD_BYTES])
    soundfile = _library()
    try:
        with soundfile.SoundFile(io.BytesIO(content)) as file:
            _check(file)
            samples, rate = _decode(file)
            missing = _missing(content, file, len(samples) / rate)
    except soundfile.SoundFileError as problem:
        # Without what libsndfile was doing, and to which object in memory.
        message = str(getattr(problem, "error_string", problem)).removeprefix("Error : ")
        raise _unreadable(f"{format.upper()}: {message.rstrip('.')}") from problem
    if not len(samples):
        raise _unreadable("it holds no sound")
    if not np.isfinite(samples).all():
        raise _unreadable("it holds samples that are no numbers")
    return Sound(samples, rate, format, missing)


def _library() -> Any:
    try:
        import soundfile
    except ImportError as missing:
        raise ExtraNeeded(
            "Reading recordings needs soundfile: pip install 'kinedex[audio]'."
        ) from missing
    except OSError as missing:  # the wheel without a libsndfile for this machine
        raise ExtraNeeded(f"soundfile cannot load libsndfile: {missing}.") from missing
    return soundfile


def _check(file: Any) -> None:
    """Refuse a recording that is too long, before it is decoded; its header may be wrong."""
    if not SAMPLE_RATES[0] <= file.samplerate <= SAMPLE_RATES[1]:
        raise _unreadable(f"a sample rate of {file.samplerate} Hz")
    if file.channels > MAX_CHANNELS:
        message = f"{file.channels} channels, the limit is {MAX_CHANNELS}"
        raise TooLarge(f"The recording has {message}.", places=[Place("audio", message)])


def _decode(file: Any) -> tuple[FloatArray, float]:
    step = max(1, file.samplerate // ENOUGH)
    rate = file.samplerate / step
    most = int(MAX_SECONDS * rate)
    blocks: list[FloatArray] = []
    count = 0
    while len(block := _next_block(file, step, is_first=not blocks)):
        mono = block.mean(axis=1)
        whole = len(mono) // step * step
        blocks.append(mono[:whole].reshape(-1, step).mean(axis=1))
        count += len(blocks[-1])
        if count > most:
            message = f"longer than {MAX_SECONDS:g} s"
            raise TooLarge(f"The recording is {message}.", places=[Place("audio", message)])
    empty: FloatArray = np.zeros(0, dtype=np.float32)
    return np.concatenate([empty, *blocks]), rate


def _next_block(file: Any, step: int, *, is_first: bool) -> FloatArray:
    """(n, channels) samples; none at the end, nor where a decoder gives up after the first."""
    try:
        block = file.read(BLOCK_FRAMES // step * step, dtype="float32", always_2d=True)
    except _library().SoundFileError:
        if is_first:
            raise
        return np.zeros((0, 1), dtype=np.float32)
    return np.asarray(block)


def _missing(content: bytes, file: Any, seconds: float) -> str | None:
    """What a header promises beyond the `seconds` that were decoded, and what is there."""
    promised = promised_bytes(content)
    if promised is not None and promised > len(content):
        return f"its header promises {promised} bytes, {len(content)} are there"
    declared = file.frames / file.samplerate
    if declared <= MAX_DECLARED_SECONDS and seconds < MIN_SHARE * declared:
        return f"its header promises {declared:.2f} s, {seconds:.2f} s could be decoded"
    return None


def _unreadable(message: str) -> Unreadable:
    return Unreadable(f"The recording cannot be read: {message}.", places=[Place("audio", message)])
