"""Animals are refused with reasons. People on all fours, in costumes and in cartoons are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.errors import NotHuman
from app.motion.canonical.canonical import canonicalize
from app.motion.roles.joint_roles import JointRole
from tests.motion.plausibility.creatures import ANIMALS, PEOPLE


@pytest.mark.parametrize("animal", sorted(ANIMALS))
def test_an_animal_is_refused(animal: str) -> None:
    with pytest.raises(NotHuman) as refused:
        canonicalize(ANIMALS[animal])
    assert refused.value.places


@pytest.mark.parametrize("animal", sorted(ANIMALS))
@pytest.mark.parametrize("scale", [0.01, 100.0])
def test_an_animal_of_any_size_is_refused(animal: str, scale: float) -> None:
    plain = ANIMALS[animal]
    skeleton = replace(plain.skeleton, offsets=plain.skeleton.offsets * scale)
    with pytest.raises(NotHuman):
        canonicalize(
            replace(plain, positions=plain.positions * np.float32(scale), skeleton=skeleton)
        )


def test_the_refusal_names_the_signs() -> None:
    with pytest.raises(NotHuman, match=r"four limbs.*trunk is level.*tail \(Tail1\).*`roles`"):
        canonicalize(ANIMALS["dog with human names"])


@pytest.mark.parametrize("person", sorted(PEOPLE))
def test_a_person_is_accepted(person: str) -> None:
    assert canonicalize(PEOPLE[person]).missing_roles == ()


def test_a_client_who_gives_roles_decides() -> None:
    motion = canonicalize(ANIMALS["dog with human names"], roles={JointRole.HIPS: "Pelvis"})
    assert motion.names[motion.roles[JointRole.LEFT_HAND]] == "L_Hand"
