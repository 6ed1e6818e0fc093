"""Filters of other packages: installed by pip, found by entry point, named when they fail."""

import json
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from support.builders import jittered_cube
from support.refusals import refused

import wct_plugin as wct
from wct_plugin.cli import main
from wct_plugin.errors import WctError
from wct_plugin.pipeline.json_schema import schema

DOCS = Path(__file__).parents[2] / "docs/pipelines.md"
#: The filter that the documentation shows.
GOOD = re.findall(r"```python\n(.*?)```", DOCS.read_text(), re.DOTALL)[-1]
BROKEN = "import no_such_dependency\n"
LEAVING = "import sys\nsys.exit('no licence:\\nbuy one')\n"


def wheel(folder, package, code, entry):
    """A wheel of one module, as small as pip takes it."""
    info = f"{package}-1.0.dist-info"
    file = folder / f"{package}-1.0-py3-none-any.whl"
    contents = {
        f"{package}.py": code,
        f"{info}/METADATA": f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n",
        f"{info}/WHEEL": "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
        f"{info}/entry_points.txt": f"[wct_plugin.filters]\n{entry}\n",
    }
    with zipfile.ZipFile(file, "w") as archive:
        for name, text in contents.items():
            archive.writestr(name, text)
        archive.writestr(f"{info}/RECORD", "".join(f"{name},,\n" for name in [*contents, f"{info}/RECORD"]))
    return file


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("third_party")
    wheels = [
        wheel(folder, "wct_shift", GOOD, "apply_coord_shift = wct_shift:Shift"),
        wheel(folder, "wct_broken", BROKEN, "meshing_broken = wct_broken:Broken"),
        wheel(folder, "wct_leaving", LEAVING, "meshing_leaving = wct_leaving:Leaving"),
    ]
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--target"]
    subprocess.run([*command, folder / "site", *wheels], check=True, timeout=120, capture_output=True)
    return folder / "site"


@pytest.fixture
def place(installed, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(installed))
    monkeypatch.chdir(tmp_path)
    wct.write("cube.vtu", jittered_cube(2, 0))
    return tmp_path


def test_it_is_listed_and_has_a_page_beside_one_that_fails(place, capsys):
    assert main.run(["filters"]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert "apply_coord_shift Shift the mesh along x." in printed
    assert (
        "meshing_broken filters.meshing_broken (wct_broken:Broken) cannot be imported: ModuleNotFoundError" in printed
    )
    assert "meshing_well_centered Resample" in printed
    assert main.run(["filters", "apply_coord_shift"]) == 0
    assert "How far along x" in capsys.readouterr().out
    assert main.run(["filters", "--json", "-"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert "no_such_dependency" in found["meshing_broken"]["error"]
    assert found["apply_coord_shift"]["options"]["properties"]["by"]["exclusiveMinimum"] == 0


def test_it_runs_in_pipelines_and_in_python(place, capsys):
    chain = place / "chain.json"
    chain.write_text('["cube.vtu", {"type": "filters.apply_coord_shift", "by": 2}, "out.vtu"]')
    assert main.run(["run", str(chain)]) == 0
    assert wct.read("out.vtu").points[:, 0].min() == 2.0
    assert "apply_coord_shift" in dir(wct.Filter)
    shifted = wct.Filter.apply_coord_shift(by=0.5).apply(wct.read("cube.vtu"))
    assert shifted.mesh.points[:, 0].max() == 1.5
    assert shifted.metrics == {"apply_coord_shift": {"by": 0.5}}
    assert wct.apply_filter("apply_coord_shift", wct.read("cube.vtu"))[1] == {"by": 1.0}
    assert "filters.apply_coord_shift" in schema()["$defs"]


def test_one_that_fails_to_import_is_named_and_the_others_work(place, capsys):
    message = "filters.meshing_broken (wct_broken:Broken) cannot be imported: ModuleNotFoundError: No module named"
    assert refused(capsys, "filters", "meshing_broken").startswith(message)
    assert refused(capsys, "filters", "meshing_leaving").endswith("SystemExit: no licence: buy one")
    chain = place / "chain.json"
    chain.write_text('["cube.vtu", {"type": "filters.meshing_broken"}, "out.vtu"]')
    said = refused(capsys, "run", chain)
    assert said.startswith(f"{chain}: stage 2 of 3 (filters.meshing_broken): (wct_broken:Broken) cannot be imported")
    assert not (place / "out.vtu").exists()
    with pytest.raises(WctError, match="cannot be imported"):
        _ = wct.Filter.meshing_broken
    assert "filters.meshing_broken" not in schema()["$defs"]
    assert main.run(["optimize", "cube.vtu", "out.vtu", "--goal", "3wc"]) in (0, 1)
