"""Reading and writing meshes in the formats of ``formats.py``, most of them through meshio."""

from wct_plugin.adapters.meshio_read import read
from wct_plugin.adapters.meshio_write import check_groups, write

__all__ = ["check_groups", "read", "write"]
