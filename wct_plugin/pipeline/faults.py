"""What goes wrong in a filter: by a fault of its own, or of what it was given."""

from collections.abc import Callable
from typing import Any, TypeVar

from wct_plugin.errors import InternalError, NoMeshError, WctError
from wct_plugin.mesh import SurfaceMesh, TetMesh

T = TypeVar("T")
Heard = TypeVar("Heard")


def told_apart(
    run: Callable[[Any, Callable[[Heard], bool | None]], T],
    mesh: TetMesh | SurfaceMesh | None,
    progress: Callable[[Heard], bool | None],
) -> T:
    """What ``run(mesh, progress)`` gives; a fault of ``run`` itself raises :class:`InternalError`.

    Such are arrays it made that make no mesh, and whatever else it does not raise on purpose. Without a ``mesh`` the
    arrays are what the options ask for. What ``progress`` raises comes through as it is.
    """
    thrown: list[Exception] = []

    def listening(heard: Heard) -> bool | None:
        try:
            return progress(heard)
        except Exception as error:
            thrown.append(error)
            raise

    try:
        return run(mesh, listening)
    except NoMeshError as error:
        if mesh is None:
            raise
        if isinstance(mesh, TetMesh):
            _ = mesh.topology.boundary  # raises the same where it is the mesh given that is none
        raise InternalError(f"the filter made no mesh: {error}") from error
    except (WctError, MemoryError, Warning):  # warnings are raised where the caller's filters say so
        raise
    except Exception as error:
        if any(error is one for one in thrown):
            raise
        raise InternalError(f"{type(error).__name__}: {error}") from error
