"""What a result depends on: options, versions and platform, ready for JSON."""

import math
import platform
from collections.abc import Mapping
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np

from wct_plugin.mesh import SurfaceMesh, TetMesh
from wct_plugin.pipeline.stage import Options, Stage

#: Whose versions change a result.
_PACKAGES = ("wct_plugin", "numpy", "scipy", "meshio", "pytetwild", "pymeshlab")


def options_of(stage: Stage[Options]) -> dict[str, Any]:
    """Every option that counts, as the declaration itself dumps them, ready for JSON."""
    given = stage.options
    return {name: plain(getattr(given, name)) for name in given.model_dump(warnings=False)}


@cache
def versions() -> Mapping[str, str]:
    """Versions of Python and of the packages that change a result, as installed."""
    found = {"python": platform.python_version()}
    for name in _PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:  # a neighbour that nothing has asked for
            continue
    return found


def environment() -> dict[str, Any]:
    """What a result depends on beside its input and options, ready for JSON."""
    return {"versions": dict(versions()), "platform": platform.platform()}


def plain(value: Any) -> Any:
    """Numbers, strings, lists and dicts, as JSON has them; None for what is not finite, a mesh as its file or size."""
    match value:
        case Mapping():
            return {str(key): plain(item) for key, item in value.items()}
        case list() | tuple():
            return [plain(item) for item in value]
        case np.ndarray() | np.generic():
            return plain(value.tolist())
        case float():
            return value if math.isfinite(value) else None
        case TetMesh():
            return value.source or f"<tet mesh of {len(value.tets)} tets>"
        case SurfaceMesh():
            return value.source or f"<surface of {len(value.triangles)} triangles>"
        case str() | int() | None:
            return value
        case _:
            return str(value)
