"""Every command that a document shows exists with its options; the short ones are run."""

import functools
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from shell_blocks import ROOT, Block, blocks

BUILD = Path(os.environ.get("ORB360_BINARY_DIR", ROOT / "build"))
# Programs with commands of their own, each with its own --help.
WITH_COMMANDS = ("orb360", "town")
# Programs that are not this project's.
FOREIGN = {"apt-get", "awk", "cd", "clang-format", "clang-tidy", "cmake", "ctest", "do", "done",
           "doxygen", "dpkg", "echo", "export", "ffmpeg", "for", "git", "head", "mkdir", "ninja",
           "node", "npm", "ns-train", "rm", "sudo", "time", "yes"}


@functools.cache
def printed(*command: str) -> str:
    done = subprocess.run(command, cwd=ROOT, check=False, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(command)} failed: {done.stdout.strip()[-500:]}")
    return done.stdout


def options(words: list[str]) -> set[str]:
    return {word.split("=")[0] for word in words if re.match(r"--?[a-zA-Z]", word)}


def compiles(code: str) -> bool:
    try:
        compile(code, "-c", "exec")
    except SyntaxError:
        return False
    return True


def missing(words: list[str]) -> list[str]:
    """What of a command does not exist; nothing for programs that are not this project's."""
    name, *arguments = words
    if re.match(r"\w+=", name):  # an assignment
        return missing(arguments) if arguments else []
    if name in ("python3", "/usr/bin/python3"):
        if arguments[0] == "-c":
            return [] if compiles(arguments[1]) else [arguments[1]]
        if "-m" not in arguments:
            return [] if (ROOT / arguments[0]).exists() else [arguments[0]]
        module = arguments[arguments.index("-m") + 1]
        return lacking(printed("/usr/bin/python3", "-m", module, "--help"), arguments[2:])
    if name.startswith("scripts/"):
        script = ROOT / name
        if not os.access(script, os.X_OK):
            return [name]
        text = script.read_text()
        if text.startswith("#!/usr/bin/python3"):
            text = printed(str(script), "--help")
        return lacking(text, [a for a in arguments if not a.startswith("-D")])
    if name.startswith("build/"):
        return missing_of_program(BUILD / name.removeprefix("build/"), arguments)
    return [] if Path(name).name in FOREIGN else [name]


def listed(text: str) -> list[str]:
    """The tests or benchmarks of a listing, without what gmock_main says of itself."""
    return [line for line in text.splitlines() if line and not line.startswith("Running main()")]


def missing_of_program(program: Path, arguments: list[str]) -> list[str]:
    if not program.exists():
        # A program that the documents tell to build first.
        return [] if program.name == "place_recall" else [str(program.name)]
    if program.name in WITH_COMMANDS:
        path = [word for word in arguments[:2] if re.fullmatch("[a-z]+", word)]
        if program.name == "orb360" and path[:1] != ["weights"]:
            path = path[:1]
        elif program.name == "town":
            path = path[:1]
        return lacking(printed(str(program), *path, "--help"), arguments)
    for option, listing in (("--gtest_filter", "--gtest_list_tests"),
                            ("--benchmark_filter", "--benchmark_list_tests")):
        for word in arguments:
            if word.startswith(option + "=") and not listed(printed(str(program), word, listing)):
                return [word]
    known = ("--gtest_", "--benchmark_")
    return lacking(printed(str(program), "--help"),
                   [word for word in arguments if not word.startswith(known)])


def lacking(help_text: str, words: list[str]) -> list[str]:
    return sorted(option for option in options(words)
                  if not re.search(re.escape(option) + r"(?![\w-])", help_text))


class Commands(unittest.TestCase):
    def test_every_command_shown_exists_with_the_options_shown(self) -> None:
        self.assertGreater(len(blocks()), 20)
        for block in blocks():
            for words in block.commands():
                with self.subTest(block.where, command=" ".join(words)):
                    self.assertEqual(missing(words), [])

    def test_a_command_that_does_not_exist_is_noticed(self) -> None:
        self.assertEqual(missing(["build/orb360", "run", "VIDEO", "--no-such"]), ["--no-such"])
        self.assertEqual(missing(["scripts/no_such"]), ["scripts/no_such"])
        self.assertEqual(missing(["build/slam_tests", "--gtest_filter=NoSuch.*"]),
                         ["--gtest_filter=NoSuch.*"])

    def test_a_skipped_block_says_why(self) -> None:
        for block in blocks():
            with self.subTest(block.where):
                self.assertTrue(block.is_run or re.match(r"# ci: skip \(.{8,}\)\n", block.text))

    def test_the_other_blocks_run(self) -> None:
        with tempfile.TemporaryDirectory(dir=BUILD) as name:
            folder = Path(name)
            for entry in ROOT.iterdir():
                if entry.name not in (".git", "build", "out"):
                    (folder / entry.name).symlink_to(entry)
            (folder / "build").symlink_to(BUILD)
            done = set()  # several documents may show the same commands
            for block in blocks():
                if block.is_run and block.text not in done:
                    done.add(block.text)
                    with self.subTest(block.where):
                        self.run_in(folder, block)

    def run_in(self, folder: Path, block: Block) -> None:
        # Debian's python3 first, which has the packages.
        environment = os.environ | {"PATH": "/usr/bin:" + os.environ["PATH"]}
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", block.text], cwd=folder,
                              env=environment, check=False, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT)
        self.assertEqual(done.returncode, 0, done.stdout[-2000:])


if __name__ == "__main__":
    unittest.main()
