"""Whenever a filter is stopped, it gives back a sound mesh, the best so far, and says that it was stopped."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from support.builders import ball, jittered_cube, shaken_cube
from support.core_meshes import start

import wct_plugin as wct
from wct_plugin.meshing.reference import own_boundary

TESTS = Path(__file__).parents[1]
MESHES = {
    "cube of 48 tets": lambda: jittered_cube(2),
    "cube of 162 tets": lambda: jittered_cube(3),
    "shaken cube": lambda: shaken_cube(2),
    "ball": lambda: ball(4),
    "scattered sheets": lambda: wct.read(TESTS / "data" / "scattered_facets.vtu"),
}
MESHING = "meshing_well_centered"


@pytest.mark.parametrize(
    ("mesh", "name", "options", "most", "phases"),
    [
        # Fine edges: enough work that it is stopped while the start is made, before its first round and after.
        ("cube of 48 tets", MESHING, {"goal": "3wc", "edge_length": 0.05}, 6, {"resampling": 4}),
        ("ball", MESHING, {"goal": "3wc", "edge_length": 0.1, "tolerance": 0.01}, 6, {"resampling": 4}),
        ("cube of 48 tets", MESHING, {"goal": "3wc", "edge_length": 0.05, "boundary": "fixed"}, 4, {"resampling": 2}),
        ("cube of 48 tets", MESHING, {"goal": "3wc", "edge_length": 0.05, "boundary": "keep"}, 4, {"resampling": 2}),
        ("cube of 162 tets", MESHING, {}, 60, {"local search: passes": 4, "local search: kicks": 4}),
        ("scattered sheets", MESHING, {"boundary": "fixed"}, 15, {"local search: passes": 4, "local search: kicks": 4}),
        ("scattered sheets", MESHING, {"goal": "one-sided", "effort": 100}, 5, {"conforming": 1}),
        ("cube of 162 tets", "apply_coord_well_centering", {"goal": "3wc"}, 20, {"moving vertices": 2}),
        ("shaken cube", "compute_power_weights", {}, 20, {"weighing vertices": 4}),
    ],
)
def test_stopped_at_any_call_it_gives_a_sound_mesh(tmp_path, mesh, name, options, most, phases):
    """A process per call stops there; see stopping.py for what it checks. One that crashes takes none with it."""
    wct.write(tmp_path / "in.vtu", MESHES[mesh]())
    command = [
        sys.executable,
        TESTS / "support" / "stopping.py",
        tmp_path / "in.vtu",
        name,
        json.dumps(options),
        str(most),
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    stopped = json.loads(done.stdout)
    for phase, least in phases.items():
        assert stopped.get(phase, 0) >= least, stopped


def test_a_start_stopped_before_its_first_round_has_no_tets():
    mesh = jittered_cube(2)
    own = own_boundary(mesh, 40.0)
    found = start(mesh, own, size=np.full(len(mesh.points), 0.05), progress=lambda done, bad: False)
    assert found.stats["stopped"]
    assert not found.intact
    assert len(found.mesh.tets) == len(found.mesh.points) == len(found.mesh.facets) == 0
