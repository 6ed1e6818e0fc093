"""Names and texts of files as they may be printed: nothing in them does anything to a terminal, a page or a table."""

import re
from typing import Any

#: Control characters but for tab and line feed; those that turn the direction of text or end a line unseen; halves of
#: characters, which stand for bytes of a file's name that are no text.
_ACTING = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff\ud800-\udfff]")
#: What a cell must not begin with, lest a spreadsheet takes it for a formula.
_FORMULA = ("=", "+", "-", "@", "\t", "\n")


def printable(text: str) -> str:
    """The text with a replacement character for each that would act instead of being seen."""
    return _ACTING.sub("\N{REPLACEMENT CHARACTER}", text)


def cell(value: Any) -> Any:
    """A value for a table that spreadsheets open: a text that would be a formula there gets an apostrophe before it."""
    if not isinstance(value, str):
        return value
    shown = printable(value)
    return f"'{shown}" if shown.lstrip(" ").startswith(_FORMULA) else shown
