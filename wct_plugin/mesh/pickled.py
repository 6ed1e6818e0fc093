"""How frozen meshes are pickled and copied: their fields and nothing derived; their arrays stay read-only."""

from collections.abc import Mapping
from dataclasses import fields
from types import MappingProxyType
from typing import Any

import numpy as np


class Pickled:
    """Base of frozen dataclasses of arrays, and of mappings of arrays, that were validated when they were made."""

    def __getstate__(self) -> dict[str, Any]:
        """The fields; what is derived, such as a topology, is derived anew where it is asked for."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        return {name: dict(value) if isinstance(value, Mapping) else value for name, value in values.items()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        for name, value in state.items():
            kept = value
            if isinstance(value, Mapping):
                kept = MappingProxyType({key: _read_only(one) for key, one in value.items()})
            object.__setattr__(self, name, _read_only(kept))


def _read_only(value: Any) -> Any:
    """An array as a view that cannot be written to, also where joblib or dask made it a map of a file."""
    if not isinstance(value, np.ndarray):
        return value
    view = np.asarray(value).view()
    view.setflags(write=False)
    return view
