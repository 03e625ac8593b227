"""The examples that the documents show are the files that are built."""

import re
import unittest

from shell_blocks import ROOT, documents


class ExamplesShown(unittest.TestCase):
    def test_every_example_is_shown_as_it_is(self) -> None:
        shown = {}
        for document in documents():
            pattern = r"^`(examples/\w+\.cc)`:\n\n```cpp\n(.*?)^```$"
            shown |= dict(re.findall(pattern, document.read_text(), re.M | re.S))
        examples = {str(path.relative_to(ROOT)): path.read_text()
                    for path in (ROOT / "examples").glob("*.cc")}
        self.assertGreaterEqual(len(examples), 3)
        self.assertEqual(shown, examples)


if __name__ == "__main__":
    unittest.main()
