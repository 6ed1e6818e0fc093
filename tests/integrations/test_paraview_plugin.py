"""The filters as algorithms of VTK, and what ParaView is told of them."""

import importlib
import json
import sys
import types
from xml.dom.minidom import parseString

import numpy as np
import pytest
import pyvista as pv
from support.builders import jittered_cube, two_region_cube
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow
from vtkmodules.vtkFiltersCore import vtkThreshold

import wct_plugin as wct
from wct_plugin.integrations import paraview_plugin
from wct_plugin.objects.pyvista_meshes import to_pyvista
from wct_plugin.pipeline.stage import filter_names, find_filter

CUBE = jittered_cube(4)


def result(algorithm):
    algorithm.Update()
    return pv.wrap(algorithm.GetOutputDataObject(0))


@pytest.fixture
def said():
    """What VTK says in its window."""
    window, before = vtkStringOutputWindow(), vtkOutputWindow.GetInstance()
    vtkOutputWindow.SetInstance(window)
    yield lambda: window.GetOutput()
    vtkOutputWindow.SetInstance(before)


def test_every_filter_is_there():
    for name in filter_names():
        algorithm = getattr(paraview_plugin, "".join(part.capitalize() for part in name.split("_")))()
        assert algorithm.GetNumberOfInputPorts() == (find_filter(name).takes is not None)


def test_a_filter_does_what_it_does_elsewhere():
    algorithm = paraview_plugin.ApplyCoordWellCentering()
    algorithm.SetInputDataObject(to_pyvista(CUBE))
    algorithm.SetGoal("3wc")
    algorithm.SetTolerance("")
    algorithm.SetMargin(0.01)
    grid = result(algorithm)
    expected, metrics = wct.apply_filter("apply_coord_well_centering", CUBE, goal="3wc", margin=0.01)
    assert (np.asarray(grid.points) == expected.points).all()
    assert json.loads(grid.field_data["metrics"][0])["bad_after"] == metrics["bad_after"]


def test_algorithms_follow_one_another_and_others():
    source = paraview_plugin.CreateCube()
    source.SetVariant("84")
    scalar = paraview_plugin.ComputeScalarByWellCenteredness()
    scalar.SetInputConnection(source.GetOutputPort())
    some = vtkThreshold()
    some.SetInputConnection(scalar.GetOutputPort())
    grid = result(scalar)
    name = next(name for name in grid.cell_data if "height" in name.lower() or "h" in name.lower())
    some.SetInputArrayToProcess(0, 0, 0, 1, name)
    assert 0 < result(some).n_cells <= 84
    skin = paraview_plugin.GenerateBoundarySurface()
    skin.SetInputConnection(scalar.GetOutputPort())
    surface = result(skin)
    assert isinstance(surface, pv.PolyData)
    assert surface.is_manifold
    assert surface.volume == pytest.approx(grid.volume)


def test_regions_are_those_asked_for():
    mesh = two_region_cube(2)
    grid = to_pyvista(wct.TetMesh(mesh.points, mesh.tets, cell_data={"half": mesh.regions}))
    quality = paraview_plugin.GetQuality()
    quality.SetInputDataObject(grid)
    quality.SetRegions("half")
    assert len(json.loads(result(quality).field_data["metrics"][0])["regions"]) == 2


def test_what_is_wrong_is_said_in_one_line(said):
    algorithm = paraview_plugin.MeshingWellCentered()
    algorithm.SetInputDataObject(to_pyvista(CUBE))
    algorithm.SetGoal("best")
    algorithm.Update()
    assert "filters.meshing_well_centered" in said()
    assert "allowed" in said() or "'cwc'" in said()
    assert "Traceback" not in said()


def test_paraview_is_told_of_every_filter(monkeypatch):
    """ParaView's decorators take the class and a description, which here are kept."""
    told = {}

    def keeping(kind):
        def decorator(*texts, **named):
            def keep(algorithm):
                told.setdefault(algorithm.__name__, []).append((kind, texts, named))
                return algorithm

            return keep

        return decorator

    util = types.ModuleType("paraview.util.vtkAlgorithm")
    for owner, kinds in {
        "smproxy": ["source", "filter"], "smproperty": ["xml", "input"], "smdomain": ["datatype"], "smhint": ["xml"],
    }.items():  # fmt: skip
        setattr(util, owner, types.SimpleNamespace(**{kind: keeping(f"{owner}.{kind}") for kind in kinds}))
    monkeypatch.setitem(sys.modules, "paraview", types.ModuleType("paraview"))
    monkeypatch.setitem(sys.modules, "paraview.util", types.ModuleType("paraview.util"))
    monkeypatch.setitem(sys.modules, "paraview.util.vtkAlgorithm", util)
    monkeypatch.delitem(sys.modules, "wct_plugin.integrations.paraview_plugin")
    importlib.import_module("wct_plugin.integrations.paraview_plugin")
    assert len(told) == len(filter_names())
    for name in filter_names():
        stage = find_filter(name)
        calls = told["".join(part.capitalize() for part in name.split("_"))]
        kind, _, named = calls[-1]
        assert kind == ("smproxy.source" if stage.takes is None else "smproxy.filter")
        assert named["label"].startswith("WCT ")
        panel = "".join(text for what, texts, _ in calls if what == "smproperty.xml" for text in texts)
        elements = parseString(f"<all>{panel}</all>").documentElement.childNodes
        commands = {element.getAttribute("command") for element in elements}
        algorithm = getattr(paraview_plugin, named["name"])
        assert all(hasattr(algorithm, command) for command in commands)
    texts = [text for _, texts, _ in told["MeshingWellCentered"] for text in texts]
    goal = next(text for text in texts if "Goal" in text)
    assert '<String value="one-sided"/>' in goal
    assert 'name="Margin" label="Margin" command="SetMargin" number_of_elements="1" default_values="0.02"' in goal
