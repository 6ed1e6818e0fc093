"""The JSON schema of reports, which comes with the package as ``report.schema.json``."""

import json
from pathlib import Path
from typing import Any

_FILE = Path(__file__).with_name("report.schema.json")


def text() -> str:
    """The schema as JSON."""
    return _FILE.read_text(encoding="utf-8").rstrip()


def schema() -> dict[str, Any]:
    """The schema of one report, of a list of them, and of the reports of a pipeline by their tags."""
    read: dict[str, Any] = json.loads(text())
    return read
