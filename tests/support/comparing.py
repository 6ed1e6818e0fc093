"""Comparing two meshes with everything that hangs on them."""

import dataclasses
import re
from typing import Any

import numpy as np

from wct_plugin.mesh import Cells


def flat(mesh: Any) -> dict[str, Any]:
    """Everything that hangs on a mesh, by a name, but for where it came from."""
    out: dict[str, Any] = {}
    for field in dataclasses.fields(mesh):
        value = getattr(mesh, field.name)
        if field.name in ("source", "reference", "repairs", "tag_name"):
            continue
        if isinstance(value, Cells):
            out |= {f"{field.name}.{name}": item for name, item in flat(value).items()}
        elif hasattr(value, "items"):
            out |= {f"{field.name}.{name}": np.asarray(item) for name, item in value.items()}
        else:
            out[field.name] = value
    return out


def assert_same(got: Any, wanted: Any, *, without: str = "(?!)") -> None:
    """Equal to the bit, but for the names that match ``without``."""
    got, wanted = (
        {name: item for name, item in flat(mesh).items() if not re.match(without, name)} for mesh in (got, wanted)
    )
    assert got.keys() == wanted.keys()
    for name, item in wanted.items():
        assert np.array_equal(got[name], item), name
