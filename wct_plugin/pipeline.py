"""Filters in a row: checked as a whole before anything runs, then run one after the other."""

from collections.abc import Sequence

from wct_plugin.errors import OptionError
from wct_plugin.stage import Filter, Mesh, Metrics, Options, ProgressCallback


def check(kind: type[Mesh], filters: Sequence[Filter[Options]]) -> type[Mesh]:
    """Follow the kind of mesh through ``filters`` and give the last one's; raises :class:`OptionError` on a clash."""
    for stage in filters:
        stage.check_takes(kind)
        kind = stage.gives
    return kind


def run(
    mesh: Mesh, filters: Sequence[Filter[Options]], progress: ProgressCallback | None = None
) -> tuple[Mesh, dict[str, Metrics]]:
    """Run ``filters`` in order; gives the last mesh and each filter's metrics under its name."""
    check(type(mesh), filters)
    metrics: dict[str, Metrics] = {}
    for stage in filters:
        mesh, metrics[stage.name] = stage(mesh, progress)
    return mesh, metrics


def mesher_within_tolerance(mesher: Filter[Options], optimizer: Filter[Options]) -> Filter[Options]:
    """The ``mesher`` with an ``epsilon`` of at most half the ``tolerance`` given to the optimizer, which is for both.

    An epsilon that was not given is lowered where need be; one that was raises :class:`OptionError` if too large.
    A mesher without the option keeps the surface as it is.
    """
    epsilon = mesher.options.model_dump().get("epsilon")
    tolerance = optimizer.options.model_dump()["tolerance"]
    if epsilon is None:
        return mesher
    if "tolerance" not in optimizer.options.model_fields_set or tolerance is None or epsilon <= tolerance / 2:
        return mesher
    if "epsilon" in mesher.options.model_fields_set:
        raise OptionError(
            f"filters.{mesher.name}: option 'epsilon' is {epsilon:g}; "
            f"of the tolerance of {tolerance:g} it may take half, {tolerance / 2:g}"
        )
    return type(mesher)(**mesher.options.model_dump() | {"epsilon": tolerance / 2})
