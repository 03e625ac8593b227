"""Refusal of bad input by commands."""

import contextlib
import sys
from collections.abc import Iterator


@contextlib.contextmanager
def refusing(command: str) -> Iterator[None]:
    """Ends the program with one line on stderr, and status 1, where ValueError or OSError tells what
    is wrong with a file or an option. Also a decorator, of a main function."""
    try:
        yield
    except (ValueError, OSError) as error:
        sys.exit(f"{command}: {error}")
