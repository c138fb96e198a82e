"""The tree of labels."""

from __future__ import annotations

from collections import Counter
from typing import Annotated

from pydantic import ConfigDict, Field

from app.api.schemas.base import Incoming, Label, Outgoing
from app.models.words.language.label_tree import LinkKind
from app.models.words.language.normalize import normalize_word
from app.services.library.kept_tree import LibraryTree
from app.services.library.label_tree import MAX_PARENTS


class LabelNode(Outgoing):
    """A task or a word of the library, or a broader one that stands above some of them."""

    name: str = Field(description="In lower case, with underscores for spaces.")
    parent: str | None = Field(description="Of what it is a kind; null: of nothing.")
    because: LinkKind | None = Field(
        description="people: somebody said so. phrase: the parent is the head of the phrase."
        " inflection: the parent is the base form. lexicon: the parent has the same or a broader"
        " meaning. null: it has no parent."
    )
    tasks: int = Field(description="Clips whose task it is.")
    tasks_below: int = Field(description="Clips whose task it is, or a kind of it.")
    words: int = Field(description="Clips with this word.")


class LabelTreeAnswer(Outgoing):
    """The tree of labels, by name."""

    items: list[LabelNode]

    @classmethod
    def of(cls, found: LibraryTree) -> LabelTreeAnswer:
        """The answer for a tree of the service."""
        tasks, words, below = Counter[str](), Counter[str](), Counter[str]()
        for task, count in found.tasks.items():
            path = found.tree.path(task)
            tasks[path[0]] += count
            below.update(dict.fromkeys(path, count))
        for word, count in found.words.items():
            words[normalize_word(word)] += count
        links = found.tree.links
        return cls(
            items=[
                LabelNode(
                    name=node,
                    parent=found.tree.parent(node),
                    because=links[node].kind if node in links else None,
                    tasks=tasks[node],
                    tasks_below=below[node],
                    words=words[node],
                )
                for node in sorted(found.tree.nodes)
            ]
        )


class LabelParents(Incoming):
    """What people say about the tree; it replaces all that was said before."""

    parents: dict[Label, Annotated[Label, Field(min_length=1)] | None] = Field(
        max_length=MAX_PARENTS,
        description="The parent by label; null: the label has no parent. Labels that are not named"
        " get the parent that Kinedex finds.",
    )

    model_config = ConfigDict(
        json_schema_extra={"examples": [{"parents": {"jog": "run", "box": None}}]}
    )
