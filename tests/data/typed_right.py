"""Uses of the package that type checkers must find right; nobody runs this."""

from pathlib import Path
from typing import assert_type

import wct_plugin as wct

mesh = wct.read("part.msh")
better, metrics = wct.apply_filter(
    "meshing_well_centered", mesh, goal="3wc", tolerance=1e-3, reference="part.stl", edge_length={"oxide": 0.01, "*": 1}
)
assert_type(better, wct.TetMesh)
surface, _ = wct.apply_filter("filters.generate_boundary_surface", better)
assert_type(surface, wct.SurfaceMesh)
wct.apply_filter("create_tetrahedron", name="sommerville")
wct.apply_filter("meshing_well_centered", mesh, boundary={"contact": "fixed", "*": "move"}, progress=True)
filled = wct.Reader(Path("bone.ply")) | wct.Filter.generate_tetrahedralization(edge_length=0.1)
assert_type(filled, wct.Pipeline)
chain = filled | wct.Filter.meshlab(filter="meshing_close_holes", arguments={"maxholesize": 50}, tag="closed")
both = chain | wct.Writer("bone.vtu") | wct.Writer("bone.html", worst=3, inputs=("closed",))
assert_type(both.execute(progress=True), wct.Result)
assert_type(wct.optimize("part.msh", "part.vtu", goal="cwc"), wct.TetMesh)
wct.optimize(([], []), to="meshio", seed=2)
assert_type(wct.__version__, str)
