"""The tables of docs/formats name what the programs write: every key, default and range."""

import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from shell_blocks import ROOT

BUILD = Path(os.environ.get("ORB360_BINARY_DIR", ROOT / "build"))
FORMATS = ROOT / "docs" / "formats"


def run(*command: object) -> str:
    return subprocess.run([str(word) for word in command], check=True, text=True,
                          stdout=subprocess.PIPE).stdout


def rows(document: str, heading: str = "") -> list[list[str]]:
    """The cells of the first table after `heading`, without its header."""
    text = (FORMATS / document).read_text()
    text = text[text.index(heading):]
    table = re.search(r"^\|.*\n\|[-:| ]+\|\n((?:\|.*\n)+)", text, re.M)
    assert table is not None
    return [[cell.strip() for cell in line.strip("|").split(" | ")]
            for line in table.group(1).splitlines()]


def words(text: str) -> list[str | float]:
    """Numbers by their value, however they are written."""
    return [float(word) if re.fullmatch(r"[-+.\de]*\d[-+.\de]*", word) else word
            for word in text.split()]


def names(cells: list[list[str]]) -> set[str]:
    return {name for cell in cells for name in re.findall(r"`([^`]+)`", cell[0])}


class Formats(unittest.TestCase):
    def test_configuration_lists_every_option_with_default_and_range(self) -> None:
        printed, section, comment = {}, "", ""
        for line in run(BUILD / "orb360", "config").splitlines():
            if line.strip().startswith("#"):
                comment = line.strip(" #")
            elif line.endswith(":"):
                section = line[:-1] + "."
            elif line:
                key, value = line.strip().split(": ", 1)
                prefix = section if line.startswith(" ") else ""
                limits = re.search(r"\(([^()]*)\)$", comment)
                printed[prefix + key] = (value, limits.group(1) if limits else "")
        self.assertGreater(len(printed), 50)
        documented = {row[0].strip("`"): row for row in rows("configuration.md")}
        self.assertEqual(set(documented), set(printed))
        for key, (value, limits) in printed.items():
            with self.subTest(key):
                self.assertEqual(documented[key][1].strip("`"), value)
                if limits:
                    self.assertEqual(words(documented[key][2]), words(limits))

    def test_summary_and_evaluation_list_every_key(self) -> None:
        with tempfile.TemporaryDirectory(dir=BUILD) as name:
            gpx = Path(name) / "track.gpx"
            gpx.write_text("<gpx><trk><trkseg>" + "".join(
                f'<trkpt lat="47" lon="{8 + 1e-4 * i}"><time>2025-03-14T07:00:0{i}Z</time></trkpt>'
                for i in range(8)) + "</trkseg></trk></gpx>")
            town, result = Path(name) / "town", Path(name) / "run"
            run(BUILD / "town", "render", "--town", 7, "--frames", 40, "--width", 512,
                "--depth-every", 10, "--out", town)
            run(BUILD / "orb360", "run", town, "--mask", "none", "--mesh", "--quiet", "--out",
                result)
            summary = json.loads((result / "summary.json").read_text())
            errors = json.loads(run(BUILD / "orb360", "evaluate", town, result, "--json"))
            # That these positions do not fit the path is told by the exit status.
            subprocess.run([BUILD / "orb360", "run", town, "--mask", "none", "--weights", "none",
                            "--quiet", "--positions", gpx, "--out", Path(name) / "placed"],
                           capture_output=True)
            placed = json.loads((Path(name) / "placed" / "summary.json").read_text())
            # A path of 150 m, because the town's is too short for some figures.
            path = Path(name) / "path.txt"
            path.write_text("".join(f"{i} {i} 0 0 0 0 0 1\n" for i in range(151)))
            long = json.loads(run(BUILD / "orb360", "evaluate", path, path, "--json"))
        self.assertEqual(set(summary), names(rows("summary.md")))
        self.assertEqual(set(summary["scale"]) - names(rows("summary.md", "`scale`:")), set())
        self.assertEqual(set(placed["positions"]), names(rows("summary.md", "## Positions")))
        documented = names(rows("evaluation.md"))
        self.assertEqual(set(errors) - documented, set())
        self.assertEqual(documented - set(errors) - {"depth"}, set())
        text = (FORMATS / "evaluation.md").read_text()
        documented = names(rows("evaluation.md", "`local_scale` compares"))
        self.assertEqual(set(long["local_scale"]), documented)
        self.assertNotIn(None, long["local_scale"].values())
        for key in errors["cloud"]:
            self.assertIn(f"`{key}`", text)


if __name__ == "__main__":
    unittest.main()
