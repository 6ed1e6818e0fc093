"""Files: formats, readers, writers; most formats go through meshio."""

from wct_plugin.io.read import read
from wct_plugin.io.write import check_groups, write

__all__ = ["check_groups", "read", "write"]
