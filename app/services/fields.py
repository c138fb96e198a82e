"""Checks of all values that clients send about a clip: labels, hints, metadata, keyposes, limits.

The same rules hold for a form, a JSON body, a manifest and the command line. Each function returns
the value in its normal form, and raises BadField, which names the field, for a bad value.
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Iterable, Mapping

from app.errors import BadField
from app.formats.common.names import MAX_NAME_LENGTH
from app.kinedex_error import Place
from app.models.words.language.normalize import normalize_word, normalize_words
from app.motion.canonical.units import METERS_PER_UNIT, SCALES
from app.motion.canonical.up_axis import UP_AXES
from app.motion.roles.joint_roles import JointRole
from app.motion.roles.roles import MAX_JOINTS_OF_MIDDLE
from app.motion.skeleton.recording import FRAME_RATES

MAX_TEXT = 300
"""Characters in a name or label."""
MAX_PATH = 500
"""Characters in the path of an imported file. A cursor contains a path, and must stay short."""
NO_CONTROL = "must not hold control characters"
MAX_JOINT_NAME = MAX_NAME_LENGTH
"""Characters of a joint's name; the readers accept no longer names in files."""
MAX_WORDS = 100
"""Words on one clip."""
MAX_CAPTIONS = 50
"""Captions of one clip."""
CAPTION_ENDS = re.compile(r"[\n\r|]+")
"""What is between captions in one text."""
MAX_LIMIT = 1000
"""Hits of one page."""
MAX_KEYPOSES = 10_000
"""Largest number of annotated keyposes of one clip: three hours of dancing."""
TEMPI = (20.0, 400.0)
"""Bounds of a tempo, in beats per minute."""
MAX_OFFSET = 36_000.0
"""Seconds between the start of a motion and the start of its recording."""


def bad_field(field: str, message: str) -> BadField:
    """The error for one field; message: without the field's name, as "must be a number"."""
    return BadField(f"{field}: {message}", places=[Place(field, message)])


def text(field: str, value: str | None) -> str | None:
    """A label in Unicode's NFC form without surrounding spaces; None if it is empty."""
    if value is None:
        return None
    if not isinstance(value, str):
        raise bad_field(field, "must be a string")
    tidy = unicodedata.normalize("NFC", value).strip()
    if len(tidy) > MAX_TEXT:
        raise bad_field(field, f"must not be longer than {MAX_TEXT} characters")
    if holds_control(tidy):
        raise bad_field(field, NO_CONTROL)
    return tidy or None


def holds_control(value: str) -> bool:
    """Whether the text has a control character, or half of a surrogate pair."""
    return any(unicodedata.category(c) in ("Cc", "Cs") for c in value)


def words(value: str | Iterable[str] | None) -> tuple[str, ...] | None:
    """Words in lower case, without repetitions, in the client's order; spaces separate them."""
    if value is None:
        return None
    parts = value.split() if isinstance(value, str) else list(value)
    tidy = normalize_words(filter(None, (text("words", part) for part in parts)))
    if len(tidy) > MAX_WORDS:
        raise bad_field("words", f"must not be more than {MAX_WORDS}")
    return tidy


def captions(value: str | Iterable[str] | None) -> tuple[str, ...] | None:
    """Sentences without repetitions, in the client's order; in one string, line breaks or | are
    between them."""
    if value is None:
        return None
    parts = CAPTION_ENDS.split(value) if isinstance(value, str) else list(value)
    tidy = tuple(dict.fromkeys(filter(None, (text("captions", part) for part in parts))))
    if len(tidy) > MAX_CAPTIONS:
        raise bad_field("captions", f"must not be more than {MAX_CAPTIONS}")
    return tidy


def queried_words(value: Iterable[str]) -> tuple[str, ...]:
    """The texts of a search by words: words, phrases or sentences. At least one must remain."""
    texts = tuple(filter(None, (text("words", part) for part in value)))
    if not any(map(normalize_word, texts)):
        raise bad_field("words", "at least one word is needed")
    if sum(len(one.split()) for one in texts) > MAX_WORDS:
        raise bad_field("words", f"must not be more than {MAX_WORDS}")
    return texts


def frame_rate(value: float | str | None) -> float | None:
    """A frame rate in Hz, within FRAME_RATES; an empty string is None."""
    number = parsed_number("frame_rate", value)
    lowest, highest = FRAME_RATES
    if number is not None and not lowest <= number <= highest:
        raise bad_field("frame_rate", f"must be from {lowest:g} to {highest:g} Hz")
    return number


def metres_per_unit(value: float | str | None) -> float | None:
    """Meters in one unit of the file, from a number or a name (m, cm, mm, in, ...)."""
    if isinstance(value, str) and value.strip().lower() in METERS_PER_UNIT:
        return METERS_PER_UNIT[value.strip().lower()]
    try:
        number = parsed_number("unit", value)
    except BadField as problem:
        names = ", ".join(METERS_PER_UNIT)
        raise bad_field("unit", f"must be one of {names}, or meters per unit") from problem
    if number is not None and not SCALES[0] <= number <= SCALES[1]:
        raise bad_field("unit", "must be between 0.000001 and 1000 meters")
    return number


def up_axis(value: str | None) -> str | None:
    """The axis of the file that points up: x, y, z, -x, -y or -z; an empty string is None."""
    axis = text("up_axis", value)
    if axis is None:
        return None
    if axis.lower() not in UP_AXES:
        raise bad_field("up_axis", f"must be one of {', '.join(UP_AXES)}")
    return axis.lower()


def roles(value: Mapping[str, str | list[str]] | None) -> dict[str, str | list[str]] | None:
    """Joint names by role; each key must be a JointRole. Empty is None.

    A value is the name of a joint, or a list of two names: the role is the middle of both.
    """
    if value is None:
        return None
    if not isinstance(value, Mapping):
        raise bad_field("roles", "must be an object: joint names by role")
    role_names = {role.value for role in JointRole}
    for role, joint in value.items():
        if role not in role_names:
            message = f"is not a joint role; the roles are {sorted(role_names)}"
            raise bad_field(f"roles.{role}", message)
        names = [joint] if isinstance(joint, str) else joint
        if not isinstance(names, list) or not 1 <= len(names) <= MAX_JOINTS_OF_MIDDLE:
            raise bad_field(f"roles.{role}", "must be the name of one joint, or a list of two")
        if not all(isinstance(name, str) and 0 < len(name) <= MAX_JOINT_NAME for name in names):
            message = f"must be the name of a joint, of at most {MAX_JOINT_NAME} characters"
            raise bad_field(f"roles.{role}", message)
    return dict(value) or None


def keyposes(
    value: str | Iterable[float] | None, field: str = "keyposes"
) -> tuple[float, ...] | None:
    """Seconds from the clip's start, sorted, without repetitions; a string holds spaces between."""
    if value is None:
        return None
    parts = value.split() if isinstance(value, str) else list(value)
    if len(parts) > MAX_KEYPOSES:
        raise bad_field(field, f"must not be more than {MAX_KEYPOSES}")
    times = sorted({time for part in parts if (time := parsed_number(field, part)) is not None})
    if times and times[0] < 0:
        raise bad_field(field, "must not be before the clip's start")
    return tuple(times)


def tempo(value: float | str | None) -> float | None:
    """Beats per minute, within TEMPI; an empty string is None."""
    number = parsed_number("tempo", value)
    if number is not None and not TEMPI[0] <= number <= TEMPI[1]:
        raise bad_field("tempo", f"must be from {TEMPI[0]:g} to {TEMPI[1]:g} beats per minute")
    return number


def audio_offset(value: float | str | None) -> float | None:
    """Seconds from the start of the motion to the start of its recording; negative if the
    recording starts first."""
    number = parsed_number("audio_offset", value)
    if number is not None and abs(number) > MAX_OFFSET:
        raise bad_field("audio_offset", f"must be within {MAX_OFFSET:g} s of the motion's start")
    return number


def beats(value: str | Iterable[float] | None) -> tuple[float, ...] | None:
    """Seconds from the clip's start, sorted and without repetitions; an empty list is None."""
    return keyposes(value, "beats") or None


def parsed_number(field: str, value: float | str | None) -> float | None:
    """The value as a number; an empty string is None. Raises BadField."""
    if value is None or (isinstance(value, str) and not value.strip()):
        return None
    if isinstance(value, bool):  # `float(True)` is 1.0, but JSON's true is not a number
        raise bad_field(field, "must be a number")
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError) as problem:
        raise bad_field(field, "must be a number") from problem
    if not math.isfinite(number):
        raise bad_field(field, "must be a finite number")
    return number


def path(value: str | None) -> str | None:
    """The path of a file relative to its import, with /, without empty parts, `.` and `..`."""
    if value is None:
        return None
    parts = unicodedata.normalize("NFC", value).replace("\\", "/").split("/")
    printable = ("".join(c for c in part if c.isprintable()).strip() for part in parts)
    tidy = "/".join(part for part in printable if part not in ("", ".", ".."))
    if len(tidy) > MAX_PATH:
        raise bad_field("path", f"must not be longer than {MAX_PATH} characters")
    return tidy or None


def file_name(value: str) -> str:
    """The last part of a client's file name, safe to show and to offer for download."""
    last = value.replace("\\", "/").rstrip("/").rpartition("/")[2]
    tidy = "".join(c for c in unicodedata.normalize("NFC", last) if c.isprintable()).strip()
    return tidy[-MAX_TEXT:] if tidy.strip(".") else "clip"


def stem(name: str) -> str:
    """A file name without its extension."""
    return name.rpartition(".")[0] or name


def max_distance(value: float | None) -> float | None:
    """The largest distance of a hit; None for any. Raises BadField."""
    if value is not None and not (math.isfinite(value) and value >= 0):
        raise bad_field("max_distance", "must be zero or more")
    return value


def limit(value: int) -> int:
    """The number of hits on one page, from 1 to MAX_LIMIT."""
    if not 1 <= value <= MAX_LIMIT:
        raise bad_field("limit", f"must be from 1 to {MAX_LIMIT}")
    return value
