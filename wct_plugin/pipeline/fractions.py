"""An option that is a fraction of the diagonal, given as if it were a length: the error says both."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from wct_plugin.errors import FractionError, WctError
from wct_plugin.pipeline.stage import Mesh


@contextmanager
def told_as_lengths(mesh: Callable[[], Mesh]) -> Iterator[None]:
    """Add to a :class:`FractionError` what the fractions are on the mesh that ``mesh`` gives, if it gives one."""
    try:
        yield
    except FractionError as error:
        try:
            given = mesh()
        except WctError:  # what is wrong with the mesh is said once the option is right
            raise error from None
        error.args = (f"{error}; {_lengths(error, given)}", *error.args[1:])
        raise


def _lengths(error: FractionError, mesh: Mesh) -> str:
    whole = mesh.diagonal
    said = [f"the diagonal of {mesh.source or 'the mesh'} is {whole:.4g}"]
    if error.most is not None:
        said.append(f"{error.most:g} is a length of {error.most * whole:.4g}")
    if whole and 0 < error.value / whole <= (error.most or 1.0):
        said.append(f"{error.value:g} as a length is {error.value / whole:.3g}")
    return ", ".join(said)
