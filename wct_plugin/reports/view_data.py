"""What the 3D view of a report shows of a mesh: a choice of its tets with their numbers, packed small."""

import zlib
from base64 import b64encode
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from wct_plugin.measure import compiled_quality
from wct_plugin.mesh import TetMesh
from wct_plugin.types import Bools, Floats, Ints

#: So many tets inside that have nothing wrong with them are packed.
MOST_INNER = 30_000
#: So many tets are packed in all; of bad ones the worst.
MOST = 200_000
#: A number is packed into 0 .. _STEPS between the ends of its scale; _NONE is none.
_STEPS, _NONE = 65534, 65535

_TYPES = {"f4": np.float32, "u4": np.uint32, "u2": np.uint16, "u1": np.uint8}


@dataclass(frozen=True)
class Scale:
    """The ends of what is packed and coloured; what lies beyond is packed as the nearer end."""

    low: float
    high: float

    def packed(self, values: Floats) -> Any:
        """Each value in two bytes."""
        share = (np.clip(np.nan_to_num(values, nan=self.low), self.low, self.high) - self.low) / (self.high - self.low)
        return np.where(np.isnan(values), _NONE, np.rint(_STEPS * share))


@dataclass(frozen=True)
class Frame:
    """Where the meshes of a page lie: they are moved and scaled alike, so that they can be compared."""

    center: Floats  #: (3,)
    size: float

    @classmethod
    def of(cls, meshes: Sequence[TetMesh]) -> "Frame":
        """The box round all of them."""
        low = np.min([mesh.points.min(axis=0) for mesh in meshes], axis=0)
        high = np.max([mesh.points.max(axis=0) for mesh in meshes], axis=0)
        return cls((low + high) / 2.0, float(np.linalg.norm(high - low)))

    def place(self, points: Floats) -> Floats:
        """Points in the box, whose diagonal then is 1."""
        out: Floats = (points - self.center) / self.size
        return out


@dataclass(frozen=True)
class Packed:
    """A mesh as the page carries it: ``text`` is compressed arrays in base64, ``about`` says what they are."""

    text: str
    about: Mapping[str, Any]
    note: str  #: what was left out, in words; empty where nothing was


def pack(mesh: TetMesh, frame: Frame, scales: Mapping[str, Scale], tags: Ints, apart: Floats | None) -> Packed:
    """The tets that :func:`chosen` takes, each with the place of its region among all ``tags``.

    ``apart`` (b,) is the deviation of each boundary facet, if it is known.
    """
    measured = compiled_quality.measure(mesh)
    kind = np.where(measured.completely_well_centered, 0, np.where(measured.well_centered_3, 1, 2))
    tets, note = chosen(mesh, kind, measured.min_height)
    used, corners = np.unique(mesh.tets[tets], return_inverse=True)
    skin, deviation = np.zeros(len(mesh.tets), dtype=np.int64), np.full(len(mesh.tets), np.nan)
    tet, facet = mesh.topology.boundary_half_facets.T
    np.bitwise_or.at(skin, tet, 4 << facet)
    if apart is not None:
        deviation[tet] = 0.0
        np.maximum.at(deviation, tet, apart)
    arrays = {
        "points": ("f4", frame.place(mesh.points[used])),
        "tets": ("u4", corners),
        "region": ("u4", np.searchsorted(tags, mesh.regions[tets])),
        "height": ("u2", scales["height"].packed(measured.min_height[tets])),
        "angle": ("u2", scales["angle"].packed(measured.max_face_angle[tets])),
        "deviation": ("u2", scales["deviation"].packed(deviation[tets])) if "deviation" in scales else ("u2", []),
        "flags": ("u1", kind[tets] | skin[tets]),
    }
    found = {name: np.ascontiguousarray(values, dtype=_TYPES[form]).ravel() for name, (form, values) in arrays.items()}
    about = {"tets": len(mesh.tets), "arrays": [[name, arrays[name][0], one.size] for name, one in found.items()]}
    return Packed(compressed(b"".join(one.tobytes() for one in found.values())), about, note)


def compressed(content: bytes) -> str:
    """Text that a page can carry and a browser unpacks by itself."""
    return b64encode(zlib.compress(content, 9)).decode("ascii")


def chosen(mesh: TetMesh, kind: Ints, height: Floats) -> tuple[Ints, str]:
    """Rows of the tets that are shown, and what is said of the others.

    All at the boundary, all bad ones (``kind`` is not 0) and of the others those that lie nearest to the three planes
    through the middle, so that a cut there is whole; neighbours stay together, which packs well.
    """
    boundary = np.zeros(len(mesh.tets), dtype=bool)
    boundary[mesh.topology.boundary_half_facets[:, 0]] = True
    notes: list[str] = []
    taken = boundary.copy()
    _add(taken, (kind > 0) & ~boundary, height, MOST - int(boundary.sum()), "bad tets inside, the worst", notes)
    room = min(MOST_INNER, MOST - int(taken.sum()))
    nearest = "good tets inside, those nearest to the middle planes"
    _add(taken, (kind == 0) & ~boundary, _from_middle(mesh), room, nearest, notes)
    return np.flatnonzero(taken), "; ".join(notes)


def _add(taken: Bools, wanted: Bools, order: Floats, room: int, what: str, notes: list[str]) -> None:
    """Take those that are wanted, or where there is no room for all, the first of them by ``order``."""
    rows = np.flatnonzero(wanted)
    if len(rows) > room:
        notes.append(f"{max(room, 0)} of {len(rows)} {what}")
        rows = rows[np.argsort(np.nan_to_num(order[rows], nan=-np.inf), kind="stable")[: max(room, 0)]]
    taken[rows] = True


def _from_middle(mesh: TetMesh) -> Floats:
    """(m,) how far each tet is from the nearest of the planes x, y, z = middle, as a share of the box's side."""
    middle = mesh.points[mesh.tets].mean(axis=1)
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    out: Floats = np.abs((middle - (low + high) / 2.0) / np.maximum(high - low, 1e-300)).min(axis=1)
    return out
