"""The compiled module: it takes arrays and gives arrays, and knows no file and no mesh object."""

try:
    from wct_plugin.core import _core
except ImportError as error:
    raise ImportError(
        "wct_plugin is not installed here: its compiled core (wct_plugin.core._core) is missing; "
        "run `pip install .` (or `pip install -e .`) in the source tree, with a C++20 compiler at hand"
    ) from error

__all__ = ["_core"]
