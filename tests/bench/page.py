"""The page of figures, `tests/bench/README.md`: each bench writes its own section.

A bench module has one `FIGURES = Section(...)` and prints with it. When the module's tests have
passed, the printed lines replace the module's section on the page (see `conftest.py`). So the page
shows the figures of the last run, and nobody copies figures by hand.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, field
from pathlib import Path

PAGE = Path(__file__).with_name("README.md")


@dataclass
class Section:
    """The figures of one bench module.

    key: the module's name without `test_`; title: the measured thing; trials: their kind and their
    number; chance: the figures of guessing, if they make sense.
    """

    key: str
    title: str
    trials: str
    chance: str = ""
    lines: list[str] = field(default_factory=list)

    def print(self, *parts: object, end: str = "\n", sep: str = " ") -> None:
        """Print like the built-in `print`, and store the text for the page."""
        print(*parts, end=end, sep=sep)
        self.lines.append(sep.join(map(str, parts)) + end)

    def write(self, page: Path = PAGE) -> None:
        """Replace this module's section on the page by the printed lines, or add it at the end."""
        text = page.read_text()
        begin, end = f"<!-- {self.key} -->", f"<!-- /{self.key} -->"
        written = f"{begin}\n{self._markdown()}\n{end}"
        if begin not in text:
            page.write_text(f"{text.rstrip()}\n\n{written}\n")
            return
        old = re.compile(f"{re.escape(begin)}.*?{re.escape(end)}", re.DOTALL)
        page.write_text(old.sub(lambda _: written, text))

    def _markdown(self) -> str:
        printed = "\n".join(line.rstrip() for line in "".join(self.lines).splitlines())
        facts = [
            f"- Command: `.venv/bin/pytest -m bench -s tests/bench/test_{self.key}.py`",
            f"- Trials: {self.trials}",
            *([f"- Chance: {self.chance}"] if self.chance else []),
            f"- Machine: {os.cpu_count()} cores",
        ]
        figures = f"```text\n{printed.strip(chr(10))}\n```"
        return "\n\n".join([f"## {self.title}", "\n".join(facts), figures])
