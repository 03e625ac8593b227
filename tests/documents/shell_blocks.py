"""The shell commands that the documents show."""

import re
import shlex
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Block:
    """One ```sh block. A first line "# ci: skip (why)" says that CI does not run it."""

    where: str  # file:line
    text: str

    @property
    def is_run(self) -> bool:
        return not self.text.lstrip().startswith("# ci: skip")

    def commands(self) -> list[list[str]]:
        """The words of each simple command, without comments and redirections."""
        commands = []
        for line in re.sub(r"\\\n", " ", self.text).splitlines():
            lexer = shlex.shlex(line, posix=True, punctuation_chars="|&;><")
            lexer.whitespace_split = True
            words: list[str] = []
            for word in [*lexer, ";"]:
                if set(word) <= set("|&;"):
                    if words:
                        commands.append(words)
                    words = []
                else:
                    words.append(word)
        return [words for words in commands if words]


def documents() -> list[Path]:
    """The documents of the project: those at its top, and those in docs/ and weights/."""
    folders = (ROOT / "docs", ROOT / "weights")
    return sorted([*ROOT.glob("*.md"), *(path for f in folders for path in f.rglob("*.md"))])


def blocks() -> list[Block]:
    found = []
    for document in documents():
        text = document.read_text()
        for match in re.finditer(r"^```sh\n(.*?)^```$", text, re.M | re.S):
            line = text.count("\n", 0, match.start()) + 1
            found.append(Block(f"{document.relative_to(ROOT)}:{line}", match.group(1)))
    return found
