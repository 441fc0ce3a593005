"""Fenced blocks of a page in Markdown, and the files whose content they are."""

import re
from dataclasses import dataclass

BLOCK = re.compile(r"(?:<!-- file: (\S+) -->\n)?```(\w+)\n(.*?)```", re.DOTALL)


@dataclass(frozen=True)
class Block:
    """A fenced block, and the file that it is the content of."""

    file: str
    language: str
    text: str


def blocks(page: str, language: str = "") -> list[Block]:
    """The blocks of a page, those of one language if it is named."""
    found = [Block(*match) for match in BLOCK.findall(page)]
    return [block for block in found if language in ("", block.language)]
