"""The tables of ``docs/formats.md``: each cell is a mesh with that one thing, written and read back."""

import re
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from support.comparing import flat

from wct_plugin.io import read, write
from wct_plugin.io.formats import FORMATS, Format
from wct_plugin.mesh import Cells, SurfaceMesh, TetMesh

DOCS = Path(__file__).parents[2] / "docs/formats.md"


def _tets(mesh: TetMesh) -> dict[str, tuple[dict[str, Any], str]]:
    """By column: what is put on a mesh, and a pattern of what the writer's warning calls it."""
    facets, count = mesh.topology.boundary, len(mesh.tets)
    tags = 1 + np.arange(len(facets)) % 3
    halves = np.linspace(0.5, 1.5, len(facets))
    return {
        "regions": ({"regions": 3 + np.arange(count) % 2}, "regions"),
        "facets": ({"facets": Cells(facets, tags)}, "tagged facets"),
        "edges": ({"edges": Cells(facets[:5, :2], tags[:5])}, "tagged edges"),
        "vertices": ({"nodes": Cells(facets[:1, :1], tags[:1])}, "tagged vertices"),
        "point data": ({"point_data": {"u": np.sqrt(np.arange(len(mesh.points)))}}, "point data 'u'"),
        "tet data": ({"cell_data": {"heat": np.sqrt(np.arange(count))}}, "cell data 'heat'"),
        "facet data": ({"facets": Cells(facets, tags, {"flux": halves})}, "cell data 'flux'|48 tagged facets"),
        "point sets": ({"point_sets": {"fixed": np.array([0, 2])}}, "set 'fixed' of points"),
        "tet sets": ({"tet_sets": {"core": np.array([1, 5])}}, "set 'core' of tets"),
        "facet sets": (
            {"facets": Cells(facets, tags, {}, {"inlet": np.array([1, 5])})},
            "set 'inlet' of facets|48 tagged facets",
        ),
        "names": ({"regions": np.full(count, 3), "names": {"steel": (3, 3)}}, "name 'steel'"),
    }


def _triangles(surface: SurfaceMesh) -> dict[str, tuple[dict[str, Any], str]]:
    count = len(surface.triangles)
    return {
        "tags": ({"tags": 1 + np.arange(count) % 3}, "tags of tagged facets"),
        "point data": ({"point_data": {"u": np.sqrt(np.arange(len(surface.points)))}}, "point data 'u'"),
        "triangle data": ({"cell_data": {"flux": np.sqrt(np.arange(count))}}, "cell data 'flux'"),
    }


def _back(path: Path, mesh: TetMesh | SurfaceMesh) -> tuple[Any, str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        write(path, mesh)
    (said,) = [str(warning.message) for warning in caught] or [""]
    return read(path), said.partition("so dropped: ")[2]


def _in_order(mesh: Any) -> Any:
    """Facets in the order of their vertices: SU2 keeps them by tag."""
    if isinstance(mesh, SurfaceMesh):
        return mesh
    given = mesh.facets
    order = np.lexsort(given.vertices.T)
    place = np.argsort(order)
    sets = {name: np.sort(place[members]) for name, members in given.sets.items()}
    data = {name: values[order] for name, values in given.data.items()}
    return replace(mesh, facets=Cells(given.vertices[order], given.tags[order], data, sets))


def _row(form: Format, plain: Any, things: dict[str, tuple[dict[str, Any], str]], folder: Path) -> list[str]:
    path = folder / f"part{form.suffixes[0]}"
    got, said = _back(path, plain)
    same = np.array_equal(np.sort(got.points, axis=0), np.sort(plain.points, axis=0))
    assert bool(said) != same  # coordinates are all that can be lost of a plain mesh
    row = ["yes" if same else "rounded"]
    round_numbers = replace(plain, points=np.round(plain.points, 3))
    for what, (extra, called) in things.items():
        mesh = replace(round_numbers, **extra)
        got, said = _back(path, mesh)
        bare, has, had = (flat(_in_order(one)) for one in (round_numbers, got, mesh))
        added = [name for name in had if name not in bare or not np.array_equal(had[name], bare[name])]
        kept = all(name in has and np.array_equal(has[name], had[name]) for name in added)
        # What is lost is named, and what is named is lost.
        assert bool(re.search(called, said)) != kept, (form.name, what, said)
        row.append("yes" if kept else "–")
    return row


def _table(forms: list[Format], plain: Any, things: Callable[[Any], Any], folder: Path) -> str:
    rows = [["format", "coordinates", *things(plain)]]
    rows.append(["---"] * len(rows[0]))
    for form in forms:
        name = f"{form.name} ({' '.join(form.suffixes)})"
        rows.append([name, *_row(form, plain, things(plain), folder)])
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def test_the_table_of_tetrahedral_meshes(plain: TetMesh, tmp_path: Path) -> None:
    table = _table([form for form in FORMATS if form.volume and form.writes], plain, _tets, tmp_path)
    assert table in DOCS.read_text(encoding="utf-8")


def test_the_table_of_formats_that_are_only_read() -> None:
    said = DOCS.read_text(encoding="utf-8").partition("## Formats that are only read")[2].partition("\n## ")[0]
    rows = re.findall(r"^\| ([^|]*\)) \|", said, re.MULTILINE)
    assert rows == [f"{form.name} ({' '.join(form.suffixes)})" for form in FORMATS if not form.writes]


def test_the_table_of_surfaces(plain: TetMesh, tmp_path: Path) -> None:
    skin = plain.boundary_surface()
    table = _table([form for form in FORMATS if form.surface and form.writes], skin, _triangles, tmp_path)
    assert table in DOCS.read_text(encoding="utf-8")
