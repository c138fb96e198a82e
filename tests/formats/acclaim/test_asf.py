"""ASF files: their unit, and errors with the line."""

from __future__ import annotations

import pytest

from app.errors import Unreadable
from app.formats.acclaim.amc import read_amc
from tests.formats.acclaim.files import acclaim_person, amc, asf

MOTION, SKELETON = amc(), asf()


def test_the_unit_is_read_from_the_length_or_is_unknown() -> None:
    assert read_amc(MOTION, asf(length=0.45)).metres_per_unit == pytest.approx(0.0254 / 0.45)
    person_asf, person_amc, _ = acclaim_person(frames=2, scale=100)
    for length, scale in ((b"2.54", 0.01), (b"1.0", None), (b"0", None), (b"1e-4", None)):
        skeleton = person_asf.replace(b"length 0.45", b"length " + length)
        assert read_amc(person_amc, skeleton).metres_per_unit == scale


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (b"direction 0 1 0", b"direction 0 1", 19),
        (b"direction 0 1 0", b"direction 0 nan 0", 19),
        (b"axis 0 0 20 XYZ", b"axis 0 0 20 XYY", 21),
        (b"axis 0 0 20 XYZ", b"axis 0 0 XYZ", 21),
        (b"dof rx ry rz", b"dof rx rx rz", 22),
        (b"dof rx ry rz", b"dof rx ry rw", 22),
        (b"name lower", b"name upper", 27),
        (b"name lower", b"name root", 27),
        (b"name upper", b"name", 16),
        (b"upper lower\n", b"upper tail\n", 40),
        (b"upper lower\n", b"lower lower\n", 27),
        (b"upper lower\n", b"lower upper\n", 40),
        (b"    upper lower\n", b"", 27),
        (b"angle deg", b"angle gon", 7),
        (b"length 0.45", b"length", 6),
        (b"order TX", b"ordre TX", 41),
        (b":bonedata", b":bones", 39),
        (b"  end\n:hierarchy", b":hierarchy", 36),
    ],
)
def test_an_unreadable_skeleton_is_refused_with_the_line(old: bytes, new: bytes, line: int) -> None:
    assert old in SKELETON
    with pytest.raises(Unreadable, match="The skeleton cannot be read") as caught:
        read_amc(MOTION, SKELETON.replace(old, new, 1))
    (place,) = caught.value.places
    assert place.location == f"skeleton line {line}"
    assert "expected" in place.message
