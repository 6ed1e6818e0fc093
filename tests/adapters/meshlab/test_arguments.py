"""What pymeshlab takes is asked of pymeshlab, and each wrong argument is named with what is allowed."""

import json
import subprocess
import sys
from pathlib import Path

import pymeshlab
import pytest

from wct_plugin.adapters.meshlab import run as meshlab
from wct_plugin.adapters.meshlab import script
from wct_plugin.adapters.meshlab.arguments import Catalogue

#: filter, argument, value, what the message says of it
WRONG = [
    ("meshing_close_holes", "maxholesize", "30", "'30'; allowed is an integer of 32 bits"),
    ("meshing_close_holes", "maxholesize", 2.5, "2.5; allowed is an integer of 32 bits"),
    ("meshing_close_holes", "maxholesize", True, "True; allowed is an integer of 32 bits"),
    ("meshing_close_holes", "maxholesize", 2**31, "2147483648; allowed is an integer of 32 bits"),
    ("meshing_close_holes", "selected", 1, "1; allowed is true or false"),
    ("apply_coord_taubin_smoothing", "mu", "a", "'a'; allowed is a number"),
    ("apply_coord_taubin_smoothing", "mu", float("inf"), "inf; allowed is a number"),
    ("compute_scalar_by_function_per_face", "q", 1, "1; allowed is a text"),
    *(
        ("meshing_merge_close_vertices", "threshold", value, f"{value!r}; allowed is a number in the mesh's unit, or a "
         "text of 0 to 100 %, like '1%'")
        for value in ("101%", "-1%", "nan%", "1", "%", True, [1])
    ),
    ("compute_color_from_scalar_per_vertex", "perc", 101, "101; allowed is at most 100"),
    ("compute_color_from_scalar_per_vertex", "perc", -0.5, "-0.5; allowed is at least 0"),
    *(
        ("compute_color_from_scalar_per_vertex", "colormap", value, f"{value!r}; allowed is one of 'RGB', 'Viridis', "
         "'Plasma', 'Cividis', 'Turbo', 'RdPu'")
        for value in ("rainbow", "", 17, -1)
    ),
    ("compute_color_from_scalar_per_vertex", "colormap", 1.5, "1.5; allowed is the name of a choice, or its number"),
    *(
        ("set_color_per_vertex", "color1", value, f"{value!r}; allowed is a list [red, green, blue] or [red, green, "
         "blue, alpha] of integers 0..255")
        for value in ("red", [1, 2], [1, 2, 256], [0.5, 0.5, 0.5])
    ),
    ("apply_coord_depth_smoothing", "viewpoint", [1, 2], "[1, 2]; allowed is a list of 3 numbers"),
    ("set_matrix", "transformmatrix", [[1, 2, 3, 4]], "[[1, 2, 3, 4]]; allowed is a list of 4 lists of 4 numbers"),
    ("set_camera_per_mesh", "shot", "x", "'x'; allowed is nothing: pymeshlab cannot set it"),
]  # fmt: skip

#: filter, argument, value as pymeshlab has it afterwards
RIGHT = [
    ("meshing_close_holes", "maxholesize", -(2**31), -(2**31)),
    ("apply_coord_taubin_smoothing", "mu", 1, 1.0),
    ("compute_color_from_scalar_per_vertex", "perc", 100, 100.0),
    ("compute_color_from_scalar_per_vertex", "colormap", "Turbo", 4),
    ("compute_color_from_scalar_per_vertex", "colormap", 4, 4),
    ("meshing_isotropic_explicit_remeshing", "targetlen", "50%", 3**0.5),
    ("meshing_isotropic_explicit_remeshing", "targetlen", 50, 50.0),
    ("compute_scalar_by_function_per_face", "q", "fi", "fi"),
    ("apply_coord_depth_smoothing", "viewpoint", [1, 2.5, 3], [1.0, 2.5, 3.0]),
    ("compute_selection_by_scalar_per_vertex", "maxq", 100.0, 100.0),  # out of range on the smaller probe only
]


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """What :class:`Catalogue` says of every case, from one process: one for each would take a minute."""
    code = """
import json, sys
import numpy as np
import pymeshlab
from wct_plugin.adapters.meshlab.arguments import Catalogue
from wct_plugin.adapters.meshlab.child import _probe
from wct_plugin.errors import OptionError

probes, catalogue, answers = [_probe(1.0), _probe(30.0)], Catalogue(), []
for name, key, value in json.loads(sys.argv[1]):
    step = {"filter": name, "arguments": {key: value}, "from_script": False, "where": "here"}
    try:
        given = catalogue.arguments(name, step, probes)
        took = probes[key == "maxq"].filter_parameter_values(name, **given)[key]
        answers.append(took.tolist() if isinstance(took, np.ndarray) else took)
    except OptionError as error:
        answers.append(str(error))
print(json.dumps(answers))
"""
    cases = json.dumps([case[:3] for case in WRONG + RIGHT])
    done = subprocess.run(
        [sys.executable, "-P", "-c", code, cases],
        capture_output=True,
        text=True,
        timeout=120,
        cwd=tmp_path_factory.mktemp("answers"),
        check=True,
    )
    found: list[str] = json.loads(done.stdout)
    return found


@pytest.mark.parametrize("number", range(len(WRONG)), ids=lambda k: f"{WRONG[k][0]}-{WRONG[k][2]}")
def test_wrong_arguments(number: int, answers: list[str]) -> None:
    _, key, _, said = WRONG[number]
    assert answers[number] == f"here: argument {key!r} is {said}"


@pytest.mark.parametrize("number", range(len(RIGHT)), ids=lambda k: f"{RIGHT[k][0]}-{RIGHT[k][2]}")
def test_right_arguments(number: int, answers: list[str]) -> None:
    expected = RIGHT[number][3]
    assert answers[len(WRONG) + number] == (expected if isinstance(expected, str) else pytest.approx(expected))


def test_the_catalogue_is_whole(capfd: pytest.CaptureFixture[str]) -> None:
    """The kinds are read from what pymeshlab prints; its dictionaries know the same names."""
    meshes = pymeshlab.MeshSet()
    meshes.create_cube()
    meshes.compute_scalar_by_function_per_face(q="fi")
    catalogue = Catalogue()
    assert len(catalogue.filters) > 250
    for name in catalogue.filters:
        assert catalogue.kinds(name).keys() == meshes.filter_parameter_values(name).keys(), name
    assert capfd.readouterr().out == ""


def test_display_names_old_and_new(tmp_path: Path) -> None:
    """A script of MeshLab has display names, which pymeshlab's list of old names knows but for the newest."""
    names = [
        "create_dodecahedron_sym",
        "meshing_surface_subdivision_doo_sabin",
        "compute_normal_by_function_per_face",
        "compute_scalar_by_shape_diameter_function_per_vertex",
        "meshing_re_orient_faces_coherently",
        "meshing_re_orient_faces_by_geometry",
        "apply_coord_developability_of_mesh",
        "generate_alpha_wrap",
        "compute_scalar_by_volumetric_obscurance",
        "meshing_decimation_quadric_edge_collapse",
        "meshing_surface_subdivision_ls3_loop",
        "create_grid",
        "compute_texcoord_parametrization_harmonic",
    ]
    meshes = pymeshlab.MeshSet()
    for name in names:
        meshes.apply_filter(name)
    meshes.save_filter_script(str(tmp_path / "all.mlx"))
    steps = meshlab.read_script(tmp_path / "all.mlx")
    catalogue = Catalogue()
    found = [catalogue.find({"filter": step.filter, "from_script": True, "where": ""}) for step in steps]
    assert found == names
    assert meshlab.check([steps]) == [""]


def test_a_script_s_values(tmp_path: Path) -> None:
    path = tmp_path / "a.mlx"
    path.write_text(
        '<!DOCTYPE FilterScript>\n<FilterScript><filter name="A &lt;b>"><Param name="c" type="RichColor" r="1" g="2" '
        'b="3" a="4"/><Param name="p" x="1.5" y="2" z="3"/><Param name="m" '
        + " ".join(f'val{k}="{k}"' for k in range(16))
        + '/><Param name="s" value=""/></filter></FilterScript>'
    )
    [(name, arguments)] = script.read(path)
    assert name == "A <b>"
    assert arguments == {
        "c": ["1", "2", "3", "4"],
        "p": ["1.5", "2", "3"],
        "m": [str(k) for k in range(16)],
        "s": "",
    }
