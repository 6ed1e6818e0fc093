"""The one place where meshio is imported. Nothing in it is altered: other programs in this process use it too."""

import importlib
from typing import Any


def meshio_module(name: str = "") -> Any:
    """Meshio itself, or one of its modules, such as ``gmsh``."""
    return importlib.import_module(f"meshio.{name}" if name else "meshio")
