"""Signs in the names of joints that a body is an animal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

from app.motion.roles.joint_names import side_and_word, words_of_name
from app.motion.roles.joint_roles import JointRole

MIN_LEGS = 3
"""The fewest legs on one side of a body with more than four limbs."""
MANY_LEGS_WEIGHT = 6
"""More than all signs of a person together have."""

_LIMBS = frozenset(("leg", "paw", "upleg"))
_PLACES = frozenset(("front", "fore", "hind", "rear", "back", "mid", "middle"))
_ANIMAL = frozenset(
    (
        "foreleg", "frontleg", "hindleg", "rearleg", "backleg", "midleg", "forelimb", "hindlimb",
        "paw", "frontpaw", "hindpaw", "hoof", "hooves", "fetlock", "pastern", "withers", "hock",
        "horselink", "tentacle", "pincer", "pedipalp", "flipper", "udder", "cannonbone",
    )
)  # fmt: skip
"""Words for parts of the body that no person has."""
_COSTUME = frozenset(
    ("wing", "wings", "claw", "beak", "snout", "tusk", "antenna", "feather", "horn", "mane")
)
"""Words for parts that a person in a costume may have, too."""
_NO_TAIL = frozenset(("pony", "pig", "hair", "coat", "shirt", "dress", "ribbon", "cape"))


Sign = tuple[int, str]
"""The weight of a sign, and the reason."""
KEPT_SKELETONS = 64
"""The signs of so many skeletons are kept, because many clips have the same one."""


@dataclass(frozen=True, slots=True)
class Names:
    """The names of joints. names, parents: (joints,). roles: the joint of each role."""

    names: tuple[str, ...]
    parents: tuple[int, ...]
    roles: tuple[tuple[JointRole, int], ...]

    def in_trees(self) -> list[tuple[str, ...]]:
        """(joints,) the words of each joint of a tree. Labels of markers count as having none.

        People have markers at the front of the leg and three markers on one leg.
        """
        above = set(self.parents)
        return [
            words_of_name(name) if self.parents[joint] >= 0 or joint in above else ()
            for joint, name in enumerate(self.names)
        ]

    def has_grandchild(self, joint: int) -> bool:
        """Whether at least two bones hang below the joint."""
        children = {child for child, parent in enumerate(self.parents) if parent == joint}
        return any(parent in children for parent in self.parents)


@lru_cache(maxsize=KEPT_SKELETONS)
def named_signs(body: Names) -> tuple[Sign, ...]:
    """The weight and the reason of each sign. The names of a person have at most 2 together."""
    return tuple(_signs(body))


def _signs(body: Names) -> Iterator[Sign]:
    words = body.in_trees()
    animal = next((joint for joint, found in enumerate(words) if _is_animal(found)), None)
    if animal is not None:
        yield 3, f"it has a joint {body.names[animal]}"
    legs = _legs(body, words)
    if legs >= MIN_LEGS:
        yield MANY_LEGS_WEIGHT, f"it has {legs} legs on one side"
    wing = next((joint for joint in _arms(body) if _is_wing(words[joint])), None)
    if wing is not None:
        yield 3, f"its arm is a wing ({body.names[wing]})"
    costume = next((joint for joint, found in enumerate(words) if _COSTUME & set(found)), None)
    if costume is not None:
        yield 1, f"it has a joint {body.names[costume]}"
    tail = next((joint for joint, found in enumerate(words) if _is_tail(joint, found, body)), None)
    if tail is not None:
        yield 1, f"it has a tail ({body.names[tail]})"


def _is_animal(words: Sequence[str]) -> bool:
    together = any(one + two in _ANIMAL for one, two in pairwise(words))
    placed = any(one in _PLACES and two in _LIMBS for one, two in pairwise(words))
    placed |= any(one in _LIMBS and two in _PLACES for one, two in pairwise(words))
    return bool(_ANIMAL & set(words)) or together or placed


def _is_wing(words: Sequence[str]) -> bool:
    return any(word.startswith("wing") for word in words)


def _arms(body: Names) -> list[int]:
    ends = ("shoulder", "elbow", "hand")
    return [joint for role, joint in body.roles if role.endswith(ends)]


def _is_tail(joint: int, words: Sequence[str], body: Names) -> bool:
    """Whether the joint is a tail that does not hang from the head, as hair does."""
    if not any(word == "tail" for word in words) or _NO_TAIL & set(words):
        return False
    upper = {joint for role, joint in body.roles if role in (JointRole.HEAD, JointRole.NECK)}
    while joint >= 0:
        if joint in upper:
            return False
        joint = body.parents[joint]
    return True


def _legs(body: Names, words: Sequence[Sequence[str]]) -> int:
    """The number of legs on the side that has more: joints named so, not below another one."""
    counts = {"left": 0, "right": 0}
    is_leg = ["leg" in found for found in words]
    for joint, name in enumerate(body.names):
        side, _ = side_and_word(name)
        if side is None or not is_leg[joint] or _is_below_leg(joint, is_leg, body.parents):
            continue
        counts[side] += body.has_grandchild(joint)
    return max(counts.values())


def _is_below_leg(joint: int, is_leg: Sequence[bool], parents: Sequence[int]) -> bool:
    while (joint := parents[joint]) >= 0:
        if is_leg[joint]:
            return True
    return False
