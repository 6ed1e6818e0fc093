"""What the documents' commands are tried on."""

from pathlib import Path

import pytest
from support.typing_in import type_in


@pytest.fixture(scope="session")
def samples(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What ``wct demo`` leaves: it takes a while, and most documents begin with it."""
    place = tmp_path_factory.mktemp("demo")
    type_in(["wct", "demo"], place)
    return place
