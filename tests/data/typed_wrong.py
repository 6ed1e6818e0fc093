"""Uses of the package that type checkers must find wrong, at each line that says so; nobody runs this."""

import wct_plugin as wct

mesh = wct.read("part.msh")
wct.apply_filter("meshing_wellcentered", mesh)  # wrong
wct.apply_filter("meshing_well_centered", mesh, gaol="3wc")  # wrong
wct.apply_filter("meshing_well_centered", mesh, goal="4wc")  # wrong
wct.apply_filter("create_cube", mesh)  # wrong
tets: wct.TetMesh = wct.apply_filter("generate_boundary_surface", mesh)[0]  # wrong
wct.Filter.meshing_wel_centered()  # wrong
wct.Filter.meshing_well_centered(tolerence=1e-3)  # wrong
wct.Filter.meshing_well_centered(goal="best")  # wrong
wct.Filter.generate_tetrahedralization(edge_length="long")  # wrong
wct.Filter.create_from_voxels()  # wrong
wct.optimize("part.msh", effrt=2)  # wrong
wct.optimize("part.msh", to="mshio")  # wrong
wct.optimze("part.msh")  # wrong
wct.Reader("part.msh", region="zone")  # wrong
wct.Writer("part.msh", versoin="4.1")  # wrong
wct.Writer.report(filename="part.html", worst="all")  # wrong
