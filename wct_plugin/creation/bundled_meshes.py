"""Meshes that come with the package, in ``data/``: coordinates of few decimals, positive tets, exactly verified."""

import json
from functools import cache
from pathlib import Path

import numpy as np

from wct_plugin.types import Floats, Ints

_FOLDER = Path(__file__).with_name("data")


def names() -> list[str]:
    """The bundled meshes."""
    return sorted(file.stem for file in _FOLDER.glob("*.json"))


@cache
def load(name: str) -> tuple[Floats, Ints]:
    """Points (n, 3) and positive tets (m, 4) of the bundled mesh ``name``; both are read-only."""
    content = json.loads((_FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    points, tets = np.array(content["points"], np.float64), np.array(content["tets"], np.int64)
    points.setflags(write=False)
    tets.setflags(write=False)
    return points, tets
