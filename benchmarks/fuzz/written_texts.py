"""Small files as people write them by hand: dialects that none of the libraries at hand writes."""

_NODES = "1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n5, 1, 1, 1\n"

ABAQUS_PARTS = f"""*HEADING
two parts
*PART, NAME=BLOCK
*NODE, NSET=ALL
{_NODES}*ELEMENT, TYPE=C3D4, ELSET=STEEL
1, 1, 2, 3, 4
2, 2, 5, 3, 4
*ELSET, ELSET=BOTH, GENERATE
1, 2, 1
*NSET, NSET=FEW
1, 3
*SURFACE, NAME=SKIN, TYPE=ELEMENT
STEEL, S1
*END PART
*ASSEMBLY, NAME=A
*INSTANCE, NAME=I1, PART=BLOCK
*END INSTANCE
*INSTANCE, NAME=I2, PART=BLOCK
5, 0, 0
5, 0, 0, 5, 0, 1, 90
*END INSTANCE
*NSET, NSET=JOINT, INSTANCE=I1
1, 2
*END ASSEMBLY
*MATERIAL, NAME=IRON
*ELASTIC
210000, 0.3
"""

ABAQUS_INCLUDE = {
    "main.inp": "*HEADING\nblock\n*NODE, NSET=N\n*INCLUDE, INPUT=nodes.inp\n"
    "*ELEMENT, TYPE=C3D4, ELSET=E\n1,1,2,3,4\n2,2,5,\n3,4\n",
    "nodes.inp": f"*NODE\n{_NODES}",
}

_LARGE = "".join(
    f"GRID*   {k:>16}{'':16}{x:>16.6f}{y:>16.6f}*\n*       {z:>16.6f}\n"
    for k, (x, y, z) in enumerate([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)], start=1)
)
NASTRAN_LARGE = (
    "SOL 101\nCEND\nTITLE = BLOCK\nBEGIN BULK\n"
    + _LARGE
    + "CTETRA  "
    + "".join(f"{n:>8}" for n in (1, 7, 1, 2, 3, 4))
    + "\nCTETRA  "
    + "".join(f"{n:>8}" for n in (2, 8, 2, 5, 3, 4))
    + "\nCTRIA3  "
    + "".join(f"{n:>8}" for n in (3, 9, 1, 2, 3))
    + "\nENDDATA\n"
)
NASTRAN_FREE = (
    "BEGIN BULK\n"
    "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,1.,0.\nGRID,4,,0.,0.,1.\nGRID,5,,1.,1.,1.-1\n"
    "CTETRA,1,7,1,2,3,4\nCTETRA,2,8,2,5,3,4\nCTRIA3,3,9,1,2,3\nPSOLID,7,1\nENDDATA\n"
)

MEDIT = """MeshVersionFormatted 2 # by hand
Dimension
3
Vertices
5
0 0 0 1
1 0 0 1
0 1 0 1
0 0 1 2
1 1 1 2
Triangles
2
1 2 3 5
2 3 4 6
RequiredTriangles 1
1
Edges
1
1 2 9
Ridges
1
1
Corners
1
4
Tetrahedra
2
1 2 3 4 1
2 5 3 4 2
End
"""

SU2 = """% by hand
NDIME= 3
NELEM= 2
10 0 1 2 3 0
10 1 4 2 3 1
NPOIN= 5
0 0 0 0
1 0 0 1
0 1 0 2
0 0 1 3
1 1 1 4
NMARK= 2
MARKER_TAG= wall
MARKER_ELEMS= 1
5 0 1 2
MARKER_TAG= far
MARKER_ELEMS= 1
5 1 2 3
"""

OBJ = (
    "# by hand\nmtllib a.mtl\nv 0 0 0\nv 1 0 0 1.0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvt 0 0\n"
    "g a b\nf 1 3 2\nf 1/1/1 2/1/1 4//1\ng c\nf -3 -2 -1\nf 1 4 3\n"
)
OFF = (
    "COFF # by hand\n4 4 6\n0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n0 1 0 0 0 0 1\n0 0 1 0 0 0 1\n"
    "3 0 2 1\n3 0 1 3 1 0 0\n3 1 2 3\n3 0 3 2\n"
)
PLY = (
    "ply\nformat ascii 1.0\ncomment by hand\n"
    "element vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
    "property uchar red\nelement face 4\nproperty list uchar uint vertex_index\nproperty float quality\n"
    "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n"
    "0 0 0 1\n1 0 0 2\n0 1 0 3\n0 0 1 4\n3 0 2 1 .5\n3 0 1 3 .5\n3 1 2 3 .5\n3 0 3 2 .5\n0 1\n"
)
STL = "solid by hand\n" + "".join(
    "facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {a} {b} {c}\n" for a, b, c in face) + "endloop\nendfacet\n"
    for face in (
        ((0, 0, 0), (0, 1, 0), (1, 0, 0)),
        ((0, 0, 0), (1, 0, 0), (0, 0, 1)),
        ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
        ((0, 0, 0), (0, 0, 1), (0, 1, 0)),
    )
) + "endsolid by hand\n"  # fmt: skip

TETGEN = {
    "main.ele": "# by hand\n2 4 1\n1 1 2 3 4 7\n2 2 5 3 4 8\n",
    "main.node": "5 3 1 1\n1 0 0 0 0.5 1\n2 1 0 0 0.5 1\n3 0 1 0 0.5 1\n4 0 0 1 0.5 1\n5 1 1 1 0.5 1\n",
    "main.face": "2 1\n1 1 2 3 5\n2 2 3 4 6\n",
}

PYDEC = {
    "main.xml": '<?xml version="1.0" ?>\n<mesh type="simplicial_mesh">\n\t<elements>\n'
    '\t\t<file name="main.elements"/>\n'
    '\t</elements>\n\t<vertices>\n\t\t<file name="main.vertices"/>\n\t</vertices>\n</mesh>\n',
    "main.elements": "4\ndims=2,4\ndtype=int32\nformat=basic\nversion=1.0\n0 1 2 3\n1 4 2 3\n",
    "main.vertices": "4\ndims=5,3\ndtype=float64\nformat=basic\nversion=1.0\n0.0 0.0 0.0\n1.0 0.0 0.0\n0.0 1.0 0.0\n"
    "0.0 0.0 1.0\n1.0 1.0 1.0\n",
}

DOLFIN = {
    "main.xml": '<?xml version="1.0"?>\n<dolfin>\n<mesh celltype="tetrahedron" dim="3">\n<vertices size="5">\n'
    + "".join(
        f'<vertex index="{k}" x="{x}" y="{y}" z="{z}"/>\n'
        for k, (x, y, z) in enumerate([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)])
    )
    + '</vertices>\n<cells size="2">\n<tetrahedron index="0" v0="0" v1="1" v2="2" v3="3"/>\n'
    '<tetrahedron index="1" v0="1" v1="2" v2="3" v3="4"/>\n</cells>\n</mesh>\n</dolfin>\n',
    "main_facet_region.xml": '<?xml version="1.0"?>\n<dolfin>\n<mesh_function type="uint" dim="2" size="7">\n'
    + "".join(f'<entity index="{k}" value="{k % 3}"/>\n' for k in range(7))
    + "</mesh_function>\n</dolfin>\n",
}

PVTU_HEAD = (
    '<VTKFile type="PUnstructuredGrid" version="0.1" byte_order="LittleEndian"><PUnstructuredGrid GhostLevel="0">\n'
    '<PPoints><PDataArray type="Float64" NumberOfComponents="3"/></PPoints>\n'
    '<Piece Source="part0.vtu"/>\n<Piece Source="part1.vtu"/>\n</PUnstructuredGrid></VTKFile>\n'
)

VTK_ASCII = """# vtk DataFile Version 3.0
by hand
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 5 double
0 0 0 1 0 0 0 1 0 0 0 1 1 1 1
CELLS 3 14
4 0 1 2 3
4 1 4 2 3
3 0 1 2
CELL_TYPES 3
10
10
5
CELL_DATA 3
SCALARS material int 1
LOOKUP_TABLE default
1 2 5
FIELD more 1
heat 1 3 double
0.5 0.25 1
POINT_DATA 5
VECTORS u float
0 0 0 1 0 0 0 1 0 0 0 1 1 1 1
"""

VTU_ASCII = """<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>
<Piece NumberOfPoints="5" NumberOfCells="2"><PointData Scalars="t"><DataArray type="Float32" Name="t" format="ascii">
1 2 3 4 5</DataArray></PointData><CellData><DataArray type="Int32" Name="material" format="ascii">1 2</DataArray>
</CellData><Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0 0 0 1 1 1 1
</DataArray></Points><Cells><DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 3 1 4 2 3</DataArray>
<DataArray type="Int32" Name="offsets" format="ascii">4 8</DataArray><DataArray type="UInt8" Name="types"
format="ascii">10 10</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>
"""

XDMF_XML = """<Xdmf Version="3.0"><Domain><Grid Name="g" GridType="Uniform">
<Topology TopologyType="Mixed" NumberOfElements="3"><DataItem Format="XML" DataType="Int" Dimensions="14">
6 0 1 2 3 6 1 4 2 3 4 0 1 2</DataItem></Topology>
<Geometry GeometryType="XYZ"><DataItem Format="XML" DataType="Float" Precision="8" Dimensions="5 3">
0 0 0 1 0 0 0 1 0 0 0 1 1 1 1</DataItem></Geometry>
<Attribute Name="material" AttributeType="Scalar" Center="Cell"><DataItem Format="XML" DataType="Int" Dimensions="3">
1 2 5</DataItem></Attribute></Grid></Domain></Xdmf>
"""

#: Folders of one mesh each, by name: what is in them, by file; the one that is read is called main.
WRITTEN: dict[str, dict[str, str]] = {
    "hand-abaqus-parts": {"main.inp": ABAQUS_PARTS},
    "hand-abaqus-include": ABAQUS_INCLUDE,
    "hand-nastran-large": {"main.bdf": NASTRAN_LARGE},
    "hand-nastran-free": {"main.nas": NASTRAN_FREE},
    "hand-medit": {"main.mesh": MEDIT},
    "hand-su2": {"main.su2": SU2},
    "hand-obj": {"main.obj": OBJ},
    "hand-off": {"main.off": OFF},
    "hand-ply": {"main.ply": PLY},
    "hand-stl": {"main.stl": STL},
    "hand-tetgen": TETGEN,
    "hand-pydec": PYDEC,
    "hand-dolfin": DOLFIN,
    "hand-vtk": {"main.vtk": VTK_ASCII},
    "hand-vtu": {"main.vtu": VTU_ASCII},
    "hand-xdmf": {"main.xdmf": XDMF_XML},
    "hand-pvtu": {
        "main.pvtu": PVTU_HEAD,
        "part0.vtu": VTU_ASCII,
        "part1.vtu": VTU_ASCII.replace("0 0 0 1 0 0 0 1 0 0 0 1 1 1 1", "5 0 0 6 0 0 5 1 0 5 0 1 6 1 1"),
    },
}
