"""The other side of :mod:`wct_plugin.adapters.meshlab.run`: the one file that imports pymeshlab, run in a folder.

It reads ``runs.json``, lists of steps, and where there is one ``given.npz``, a surface for the one run; it writes
``answer.json`` and ``made.npz``. The answer is ``steps`` (what was run), or without a surface ``faults`` (a message per
run, empty where there is none), or ``refused`` or ``failed`` with a message.
"""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pymeshlab

from wct_plugin.adapters.meshlab.arguments import Catalogue
from wct_plugin.errors import NeighbourError, OptionError


def main() -> None:
    """Check the steps; run them where there is a surface."""
    # Meshes are loaded before anything can fail: after an exception pymeshlab's next load may die.
    given = _load() if Path("given.npz").exists() else None
    probes = [_probe(1.0), _probe(30.0)]
    catalogue, runs = Catalogue(), json.loads(Path("runs.json").read_text(encoding="utf-8"))
    answer: dict[str, Any]
    try:
        if given is None:
            answer = {"faults": [_fault(steps, catalogue, probes) for steps in runs]}
        else:
            answer = {"steps": _run(given, runs[0], catalogue, probes)}
    except OptionError as error:
        answer = {"refused": str(error)}
    except NeighbourError as error:
        answer = {"failed": str(error)}
    Path("answer.json").write_text(json.dumps(answer), encoding="utf-8")


def _calls(
    steps: list[dict[str, Any]], catalogue: Catalogue, probes: list[pymeshlab.MeshSet]
) -> list[tuple[str, dict[str, Any], dict[str, Any]]]:
    """For each step pymeshlab's name, its arguments as pymeshlab takes them, and the step."""
    calls = []
    for step in steps:
        name = catalogue.find(step)
        calls.append((name, catalogue.arguments(name, step, probes), step))
    return calls


def _fault(steps: list[dict[str, Any]], catalogue: Catalogue, probes: list[pymeshlab.MeshSet]) -> str:
    try:
        _calls(steps, catalogue, probes)
    except OptionError as error:
        return str(error)
    return ""


def _run(
    given: pymeshlab.MeshSet, steps: list[dict[str, Any]], catalogue: Catalogue, probes: list[pymeshlab.MeshSet]
) -> list[dict[str, Any]]:
    calls, log = _calls(steps, catalogue, probes), []
    for name, arguments, step in calls:
        if len(calls) > 1:
            sys.stdout.buffer.write(f"{step['where']}\n".encode(errors="replace"))  # the last words of a crash
            sys.stdout.flush()
        log.append(_apply(given, name, arguments, step, catalogue))
    _save(given)
    return log


def _probe(size: float) -> pymeshlab.MeshSet:
    """A small mesh; those of two sizes agree only about what does not depend on the mesh."""
    points = np.vstack([np.eye(3), -np.eye(3)])
    faces = np.array([(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)])
    quality = size * np.arange(1.0, 9.0)
    probe = pymeshlab.MeshSet()
    probe.add_mesh(pymeshlab.Mesh(size * points, faces, v_scalar_array=quality[:6], f_scalar_array=quality))
    return probe


def _load() -> pymeshlab.MeshSet:
    names = {
        "point quality": "v_scalar_array",
        "triangle quality": "f_scalar_array",
        "point colour": "v_color_matrix",
        "triangle colour": "f_color_matrix",
    }
    with np.load("given.npz") as arrays:
        extra = {names[key]: arrays[key] for key in arrays.files if key in names}
        mesh = pymeshlab.Mesh(arrays["points"], arrays["triangles"].astype(np.int32), **extra)
    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(mesh)
    return meshes


def _apply(
    meshes: pymeshlab.MeshSet, name: str, arguments: dict[str, Any], step: dict[str, Any], catalogue: Catalogue
) -> dict[str, Any]:
    """Run one filter; afterwards the current mesh is the surface it gave, or the one it changed."""
    before, current, where = {mesh.id() for mesh in meshes}, meshes.current_mesh_id(), step["where"]
    try:
        catalogue.arguments(name, step, [meshes])  # ranges that depend on the mesh
        used = meshes.filter_parameter_values(name, **arguments)
        measured = meshes.apply_filter(name, **arguments)
    except OptionError:
        raise
    except pymeshlab.MissingComponentException as error:
        raise NeighbourError(f"{where} failed: the surface lacks what it works on, as quality or colour") from error
    except Exception as error:  # pymeshlab raises RuntimeError and others besides its own
        reason = " ".join(str(error).rpartition("Details:")[2].split())
        raise NeighbourError(f"{where} failed: {reason}") from error
    layers = [mesh for mesh in meshes if mesh.id() not in before]
    surfaces = [mesh for mesh in layers if mesh.face_number()]
    if len(surfaces) > 1:
        raise NeighbourError(f"{where} gives {len(surfaces)} surfaces; allowed is one")
    if surfaces:
        meshes.set_current_mesh(surfaces[0].id())
    elif layers and name.startswith(("generate_", "create_")):
        raise NeighbourError(f"{where} gives {layers[0].vertex_number()} points without a triangle, not a surface")
    elif layers:
        meshes.set_current_mesh(current)  # the new layers hold samples
    if not meshes.current_mesh().face_number():
        raise NeighbourError(f"{where} leaves no triangle")
    return {"filter": name, "arguments": _plain(used), "measures": _plain(measured or {})}


def _save(meshes: pymeshlab.MeshSet) -> None:
    mesh = meshes.current_mesh()
    made = {"points": mesh.transformed_vertex_matrix(), "triangles": mesh.face_matrix().astype(np.int64)}
    given = set()
    if mesh.id() == 0:  # the given mesh itself, not one generated from it
        with np.load("given.npz") as arrays:
            given.update(arrays.files)
    # Every mesh has quality and colour per vertex: zeros and white where nothing set them.
    if "point quality" in given or mesh.vertex_scalar_array().any():
        made["point quality"] = mesh.vertex_scalar_array()
    if "point colour" in given or (mesh.vertex_color_matrix() != 1.0).any():
        made["point colour"] = mesh.vertex_color_matrix()
    if mesh.has_face_scalar():
        made["triangle quality"] = mesh.face_scalar_array()
    if mesh.has_face_color():
        made["triangle colour"] = mesh.face_color_matrix()
    np.savez("made.npz", **made)


def _plain(value: Any) -> Any:
    """As JSON has it; numbers that are not finite become None."""
    match value:
        case dict():
            return {str(key): _plain(each) for key, each in value.items()}
        case list() | tuple():
            return [_plain(each) for each in value]
        case np.ndarray() | np.generic():
            return _plain(value.tolist())
        case float():
            return value if np.isfinite(value) else None
        case pymeshlab.BoundingBox():
            return {"min": _plain(value.min()), "max": _plain(value.max())}
        case _:
            return value if isinstance(value, str | int | None) else str(value)


if __name__ == "__main__":
    main()
