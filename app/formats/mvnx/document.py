"""Reads the parts of an MVNX file that are motion, with expat and without building a tree.

Expat is a part of Python. It never opens other files here, and a file that declares entities is
refused, so no entity is ever expanded. A tree of a file of 500 MB would need several gigabytes.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from xml.parsers import expat

from app.errors import Unreadable
from app.formats.bvh.frames import MAX_FRAMES
from app.formats.common.failures import too_large, unreadable_line
from app.formats.common.limits import MAX_JOINTS
from app.formats.common.numbers import excerpt

MAX_DEPTH = 64
"""The most levels of elements. Files have about eight."""
MAX_TEXT = 200_000
"""The most characters of the text of an element that is read."""
BLOCK_BYTES = 1 << 20
_READ = frozenset(("position", "orientation", "connector1", "connector2"))


@dataclass(slots=True)
class Frame:
    """A frame: its kind (normal, identity, tpose, ...), its line, and the numbers as text."""

    kind: str
    line: int
    position: bytes = b""
    orientation: bytes = b""


@dataclass(slots=True)
class Document:
    """segments: their names. joints: the names of the two segments of each joint, parent first.

    subjects: the names of all subjects; only the first one is read.
    """

    frame_rate: str = ""
    segments: list[str] = field(default_factory=list)
    joints: list[tuple[str, str]] = field(default_factory=list)
    frames: list[Frame] = field(default_factory=list)
    subjects: list[str] = field(default_factory=list)
    version: str = ""


def read_document(content: bytes) -> Document:
    """The parts of an MVNX file. Raises Unreadable with the line, and TooLarge."""
    return _Reader().read(content)


class _Reader:
    """Handles the events of expat."""

    def __init__(self) -> None:
        self.found = Document()
        self.open: list[str] = []
        self.text: list[str] = []
        self.length = 0
        self.connectors: list[str] = []
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = self.end
        self.parser.EntityDeclHandler = self.refuse_entity

    def read(self, content: bytes) -> Document:
        try:
            for start in range(0, len(content), BLOCK_BYTES):
                self.parser.Parse(content[start : start + BLOCK_BYTES], False)
            self.parser.Parse(b"", True)
        except expat.ExpatError as error:
            reason = expat.ErrorString(error.code)
            raise unreadable_line(error.lineno, f"expected XML, found {reason}") from None
        except (ValueError, LookupError) as error:  # an encoding that expat does not know
            raise self._unreadable(f"expected XML, found {error!s:.80}") from None
        return self.found

    def start(self, name: str, attributes: dict[str, str]) -> None:
        name = name.rpartition(":")[2]
        if len(self.open) >= MAX_DEPTH:
            raise self._unreadable(f"expected at most {MAX_DEPTH} levels of elements")
        self.open.append(name)
        if name == "subject":
            self.found.subjects.append(attributes.get("label", ""))
        if len(self.found.subjects) > 1:
            return
        if name in _READ:
            self.text, self.length = [], 0
            self.parser.CharacterDataHandler = self.characters
        else:
            self._read_attributes(name, attributes)

    def _read_attributes(self, name: str, attributes: dict[str, str]) -> None:
        if name == "mvnx":
            self.found.version = attributes.get("version", "")
        elif name == "subject":
            self.found.frame_rate = attributes.get("frameRate", "")
        elif name == "segment" and "segments" in self.open:
            self._limited(len(self.found.segments), MAX_JOINTS, "segments")
            self.found.segments.append(attributes.get("label", ""))
        elif name == "joint":
            self.connectors = []
        elif name == "frame":
            self._limited(len(self.found.frames), MAX_FRAMES, "frames")
            kind = attributes.get("type", "normal")
            self.found.frames.append(Frame(kind, self.parser.CurrentLineNumber))

    def end(self, name: str) -> None:
        name = self.open.pop()
        if self.parser.CharacterDataHandler is not None and name in _READ:
            self.parser.CharacterDataHandler = None
            self._keep(name, "".join(self.text))
        elif name == "joint" and len(self.connectors) == 2:
            self._limited(len(self.found.joints), MAX_JOINTS, "joints")
            self.found.joints.append((self.connectors[0], self.connectors[1]))

    def _keep(self, name: str, text: str) -> None:
        if name.startswith("connector"):
            self.connectors.append(text.strip().partition("/")[0])
        elif self.found.frames and "frame" in self.open:
            setattr(self.found.frames[-1], name, text.encode())

    def characters(self, text: str) -> None:
        self.length += len(text)
        if self.length > MAX_TEXT:
            raise self._unreadable(f"expected at most {MAX_TEXT} characters in an element")
        self.text.append(text)

    def refuse_entity(self, name: str, *_: object) -> None:
        raise self._unreadable(f"expected no entities, found {excerpt(name.encode())}")

    def _limited(self, count: int, most: int, what: str) -> None:
        if count >= most:
            line = self.parser.CurrentLineNumber
            raise too_large(f"line {line}", f"expected at most {most} {what}")

    def _unreadable(self, message: str) -> Unreadable:
        return unreadable_line(self.parser.CurrentLineNumber, message)
