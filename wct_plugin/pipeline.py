"""Filters in a row: checked as a whole before anything runs, then run one after the other."""

from collections.abc import Sequence

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
