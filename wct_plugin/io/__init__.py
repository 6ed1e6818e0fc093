"""Files: formats, readers, writers; most formats go through meshio.

Reader and writer are imported when first asked for: who only replaces a file whole needs neither.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from wct_plugin.io.mid_nodes import check_order
    from wct_plugin.io.reader import read
    from wct_plugin.io.writer import check_groups, write

_HOMES = {"check_groups": "writer", "check_order": "mid_nodes", "read": "reader", "write": "writer"}

__all__ = ["check_groups", "check_order", "read", "write"]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
