"""The beats of a clip from all sources, and the offset of its recording."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

from app.analysis.energy.energy import energies
from app.analysis.rhythm.beats import BeatSource
from app.analysis.rhythm.onsets import Onsets, find_onsets
from app.analysis.rhythm.rhythm import SOURCES, RhythmInput, beats_of, find_rhythm, rhythm_arrays
from app.demo import DemoClip
from app.demo.dances import Sound, dance
from app.formats.audio.reader import read_audio
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.motion.frame.body_frame import BodyTrack, body_track
from tests.bodies import motion_of, standing
from tests.recordings import without_beat


@lru_cache
def made(seed: int, sound: Sound, offset: float) -> tuple[DemoClip, BodyTrack, Onsets]:
    clip = dance(seed, bpm=90.0 + seed, seconds=14.0, sound=sound, audio_offset=offset)
    heard = read_audio(clip.audio)
    track = body_track(canonicalize(read_recording(clip.content)))
    return clip, track, find_onsets(heard.samples, heard.rate)


@pytest.mark.parametrize("sound", Sound)
@pytest.mark.parametrize("offset", [-2.37, 0.0, 0.61])
def test_a_known_offset_is_estimated_up_to_whole_beats(sound: Sound, offset: float) -> None:
    clip, track, onsets = made(21, sound, offset)
    rhythm = find_rhythm(track, onsets=onsets)
    assert rhythm.offset is not None
    assert not rhythm.offset.is_given
    beat = float(np.median(np.diff(clip.beats)))
    off = (rhythm.offset.seconds - offset) / beat
    assert abs(off - round(off)) * beat < 0.05
    assert rhythm.beats.source is BeatSource.AUDIO
    beats = np.array(clip.beats)
    assert np.abs(beats[:, None] - rhythm.beats.times).min(axis=1).max() < 0.09


BEAT = 60.0 / 95.0
"""Seconds: the beat of seed 5."""


def test_a_given_offset_is_used() -> None:
    _, track, onsets = made(5, Sound.MUSIC, 0.0)
    rhythm = find_rhythm(track, RhythmInput(audio_offset=8 * BEAT), onsets)
    assert rhythm.offset is not None
    assert (rhythm.offset.seconds, rhythm.offset.is_given) == (8 * BEAT, True)
    assert rhythm.beats.source is BeatSource.AUDIO
    assert 0.5 < rhythm.beats.confidence < 1.0
    assert rhythm.cautions == ()


def test_beats_that_the_motion_does_not_confirm_are_not_used() -> None:
    _, track, onsets = made(5, Sound.CLICKS, 0.0)
    rhythm, alone = (
        find_rhythm(track, RhythmInput(audio_offset=0.3 * BEAT), onsets),
        find_rhythm(track),
    )
    assert rhythm.offset is not None
    assert [caution.code for caution in rhythm.cautions] == ["audio_beats_doubtful"]
    np.testing.assert_array_equal(rhythm.beats.times, alone.beats.times)
    assert rhythm.beats.source is alone.beats.source is not BeatSource.AUDIO


def test_beats_continue_where_the_recording_is_silent() -> None:
    _, track, onsets = made(5, Sound.MUSIC, 0.0)
    late = find_rhythm(track, RhythmInput(audio_offset=6 * BEAT), onsets).beats
    assert late.source is BeatSource.AUDIO
    assert 0.0 <= late.times[0] < 1.0
    assert late.times[-1] <= energies(track).global_energy.size / 30.0


def test_a_recording_outside_the_motion_is_ignored() -> None:
    _, track, onsets = made(5, Sound.MUSIC, 0.0)
    apart = find_rhythm(track, RhythmInput(audio_offset=1000.0), onsets)
    assert apart.beats.source in (BeatSource.MOTION, BeatSource.NONE)
    assert [caution.code for caution in apart.cautions] == ["audio_apart"]


def test_given_beats_outside_the_motion_cause_a_caution_and_are_ignored() -> None:
    _, track, _ = made(5, Sound.MUSIC, 0.0)
    rhythm = find_rhythm(track, RhythmInput(beats=(600.0, 601.0)))
    assert rhythm.beats.source is find_rhythm(track).beats.source
    assert [caution.code for caution in rhythm.cautions] == ["beats_outside_motion"]
    some = find_rhythm(track, RhythmInput(beats=(1.0, 600.0)))
    assert (some.beats.source, some.cautions) == (BeatSource.GIVEN, ())


def test_without_beats_in_the_recording_the_motion_is_used() -> None:
    _, track, _ = made(5, Sound.MUSIC, 0.0)
    speech = find_onsets(without_beat(1, "speech"), 22050.0)
    rhythm, alone = find_rhythm(track, onsets=speech), find_rhythm(track)
    assert rhythm.beats.source is alone.beats.source is not BeatSource.AUDIO
    np.testing.assert_array_equal(rhythm.beats.times, alone.beats.times)
    assert [caution.code for caution in rhythm.cautions] == ["audio_without_beats"]


def test_a_still_body_gives_no_offset() -> None:
    _, _, onsets = made(5, Sound.MUSIC, 0.0)
    rhythm = find_rhythm(body_track(motion_of(standing(300))), onsets=onsets)
    assert rhythm.offset is None
    assert rhythm.beats.source is BeatSource.NONE
    assert [caution.code for caution in rhythm.cautions] == ["audio_offset_unknown"]


def test_given_values_have_priority() -> None:
    clip, track, onsets = made(5, Sound.MUSIC, 0.0)
    given = RhythmInput(beats=(0.5, 1.5), tempo=60.0, audio_offset=0.0)
    assert find_rhythm(track, given, onsets).beats.source is BeatSource.GIVEN
    both = find_rhythm(track, RhythmInput(tempo=47.5, audio_offset=0.0), onsets).beats
    assert (both.source, both.tempo) == (BeatSource.TEMPO, 47.5)
    halved = find_rhythm(track, RhythmInput(tempo=47.5), onsets)
    assert halved.beats.source is BeatSource.TEMPO
    assert halved.offset is not None
    alone = find_rhythm(track, RhythmInput(tempo=95.0)).beats
    assert alone.source is BeatSource.TEMPO
    beats = np.array(clip.beats)
    assert np.median(np.abs(beats[:, None] - alone.times).min(axis=1)) < 0.08


@pytest.mark.parametrize("source", SOURCES)
def test_beats_are_the_same_after_storage(source: BeatSource) -> None:
    _, track, _ = made(5, Sound.MUSIC, 0.0)
    rhythm = find_rhythm(track)
    rhythm = replace(rhythm, beats=replace(rhythm.beats, source=source))
    again = beats_of(rhythm_arrays(rhythm))
    assert (again.source, again.tempo) == (source, rhythm.beats.tempo)
    np.testing.assert_array_equal(again.times, rhythm.beats.times)
