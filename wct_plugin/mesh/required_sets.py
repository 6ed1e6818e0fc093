"""Sets that say of their members that they must stay as they are; the names are those of mmg and of Medit's files."""

#: Of facets: these stay to the bit, unless the options say otherwise of the set.
REQUIRED_TRIANGLES = "RequiredTriangles"
#: Of edges: these stay to the bit.
REQUIRED_EDGES = "RequiredEdges"
