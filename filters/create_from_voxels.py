"""``filters.create_from_voxels``: any figure of equal cubes as a well-centered mesh, by construction."""

from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict, Field, field_validator
from pydantic.json_schema import SkipJsonSchema
from wct_plugin.filters.create_cube import CubeVariant

from wct_plugin.creation import bundled_meshes, voxel_contacts, voxel_mesh
from wct_plugin.creation import metrics as creation_metrics
from wct_plugin.creation.face_groups import SIDES
from wct_plugin.errors import InputError, OptionError
from wct_plugin.io import voxel_image
from wct_plugin.mesh import TetMesh
from wct_plugin.pipeline.stage import FilterStage, Options
from wct_plugin.progress import Progress, ProgressCallback
from wct_plugin.types import Floats, Ints, Metrics

_LARGEST = 2**31 - 1  # that every format can carry as a tag
_BISECTIONS = 20  # of the way from a cube to the stretch that is asked for


class VoxelOptions(Options):
    """Which voxels, how large, and what fills each."""

    model_config = ConfigDict(arbitrary_types_allowed=True)

    voxels: SkipJsonSchema[np.ndarray] | str = Field(
        description="Array indexed x, y, z, or its file: .npy, .tif of many pages, or a folder of images, one per z;"
        " 0 is empty, other values (true: 1) become regions"
    )
    spacing: float | tuple[float, float, float] = Field(
        1.0, description="Edge length of a voxel, or three (from the shell x,y,z) as far as the tets stay well-centered"
    )
    max_bytes: int | None = Field(
        None, ge=1, description="Most bytes that images may become (none: 100 times their files, at least 256 MiB)"
    )
    variant: CubeVariant = Field("194", description="What fills a voxel: a variant of create_cube")

    @field_validator("voxels", mode="before")
    @classmethod
    def _array_or_name(cls, value: Any) -> Any:
        if isinstance(value, str | np.ndarray):
            return value
        raise ValueError("must be an array or the name of a file or folder")

    @field_validator("spacing", mode="before")
    @classmethod
    def _one_or_three(cls, value: Any) -> Any:
        try:
            parts = value.split(",") if isinstance(value, str) else np.atleast_1d(value)
            lengths = [float(part) for part in parts]
        except (TypeError, ValueError):
            lengths = []
        if len(lengths) not in (1, 3) or not all(0 < length < np.inf for length in lengths):
            raise ValueError("must be a length > 0, or three of them, in x, y and z")
        return lengths[0] if len(lengths) == 1 else tuple(lengths)


class CreateFromVoxels(FilterStage[VoxelOptions]):
    """Fill every voxel with a well-centered mesh of the cube; neighbours match, so that the whole is well-centered too.

    Each voxel has the same mesh, reflected along the axes where its index is odd; neighbours are mirror images and
    share the triangles of their common face. The values of the voxels become regions; facets of the boundary are tagged
    1 to 6, ``x_min`` to ``z_max``, by the way they face. Voxels that touch only along an
    edge or at a vertex are refused. Voxels need not quite be cubes: variant 194 stays completely well-centered while
    the longest spacing is at most 1.04 times the shortest. Variants below 84 are 3-well-centered only.
    """

    name = "create_from_voxels"
    takes = None
    gives = TetMesh
    declaration = VoxelOptions
    example: ClassVar[dict[str, Any]] = {"voxels": "ball.npy", "spacing": 0.5}

    def validate(self) -> None:  # noqa: D102
        _ = self._cells, self._cube

    def run(self, mesh: None, progress: ProgressCallback) -> tuple[TetMesh, Metrics]:  # noqa: D102
        progress(Progress("voxels", 0.0))
        cells, values = self._cells
        cube, measured = self._cube
        points, tets, facets = voxel_mesh.assemble(cells, cube.points, cube.tets)
        points *= self._spacing
        names = {SIDES[tag - 1]: (tag, 2) for tag in np.unique(facets.tags).tolist()}
        regions = np.repeat(values, len(cube.tets))
        made = TetMesh(points, tets, regions, facets, names=names, source=self._source, mends=False)
        metrics = {"tets": len(tets), "points": len(points), "voxels": len(cells), "regions": len(np.unique(values))}
        return made, measured | metrics

    @property
    def _source(self) -> str:
        return self.options.voxels if isinstance(self.options.voxels, str) else ""

    @property
    def _spacing(self) -> Floats:
        return np.broadcast_to(np.asarray(self.options.spacing, dtype=np.float64), 3)

    @cached_property
    def _cells(self) -> tuple[Ints, Ints]:
        """Indices (k, 3) of the voxels that are not empty, and their values (k,)."""
        given = self.options.voxels
        who = f"{given}: " if isinstance(given, str) else f"{self.type()}: "
        values = _whole(voxel_image.read(given, self.options.max_bytes) if isinstance(given, str) else given, who)
        cells = np.argwhere(values)
        if not len(cells):
            raise InputError(f"{who}all of the {values.size} voxels are 0; at least one must not be")
        if fault := voxel_contacts.pinch(values != 0):
            raise InputError(f"{who}{fault}")
        return cells, values[tuple(cells.T)].astype(np.int64)

    @cached_property
    def _cube(self) -> tuple[TetMesh, Metrics]:
        """What fills a voxel, and what is measured of it as it is stretched."""
        points, tets = bundled_meshes.load(f"cube_{self.options.variant}")
        cube = TetMesh(voxel_mesh.snapped(points), tets)
        tier = (
            "completely_well_centered"
            if creation_metrics.metrics(cube)["completely_well_centered"]
            else "well_centered_3"
        )

        def stretched(power: float) -> Metrics:
            return creation_metrics.metrics(TetMesh(cube.points * relative**power, tets))

        relative = self._spacing / self._spacing.min()
        measured = stretched(1.0)
        if not measured[tier]:
            low, high = 0.0, 1.0
            for _ in range(_BISECTIONS):
                middle = (low + high) / 2
                low, high = (middle, high) if stretched(middle)[tier] else (low, middle)
            wanted = " x ".join(f"{length:g}" for length in relative)
            possible = " x ".join(f"{np.floor(length * 1e4) / 1e4:g}" for length in relative**low)
            words = tier.replace("_", " ").replace("centered 3", "centered")
            raise OptionError(
                f"{self.type()}: option 'spacing' makes voxels of {wanted}, in which the {len(tets)} tets of variant "
                f"{self.options.variant} are not all {words}; stretched alike, they are up to {possible}"
            )
        return cube, measured


def _whole(values: NDArray[Any], who: str) -> NDArray[Any]:
    """The array, found to be of three axes and of truth values or whole numbers from 0."""
    if values.ndim != 3:
        raise InputError(f"{who}the voxels have shape {values.shape}; allowed are three axes, x, y and z")
    if values.dtype.kind not in "buif":
        raise InputError(f"{who}the voxels have dtype {values.dtype}; allowed are truth values and whole numbers")
    wrong = ~((values >= 0) & (values <= _LARGEST))
    if values.dtype.kind == "f":
        wrong |= values != np.floor(values)
    if wrong.any():
        first = tuple(int(index[0]) for index in np.nonzero(wrong))
        more = f" (and {int(wrong.sum()) - 1} more)" if wrong.sum() > 1 else ""
        raise InputError(
            f"{who}voxel {first} is {values[first]:g}{more}; allowed are whole numbers from 0 to {_LARGEST}"
        )
    return values
