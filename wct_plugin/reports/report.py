"""What a mesh is like, in numbers: as a dict for JSON, as rows and bars for a terminal."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import PurePath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wct_plugin.certify import certificate
from wct_plugin.certify.certificate import Certificate
from wct_plugin.measure import (
    compiled_quality,
    duals,
    fidelity,
    pinned,
    planes,
    released_creases,
    shape_floor,
    solver_view,
)
from wct_plugin.measure.coincident import Coincident, count_coincident
from wct_plugin.measure.coincident import describe as describe_coincident
from wct_plugin.measure.deviation import measure_deviation
from wct_plugin.measure.joints import Joints, count_joints
from wct_plugin.measure.joints import describe as describe_joints
from wct_plugin.measure.negative_duals import NegativeDuals, count_negative_duals
from wct_plugin.measure.quality import Quality
from wct_plugin.measure.shape_floor import ShapeFloor
from wct_plugin.measure.solver_view import SolverView
from wct_plugin.mesh import TetMesh, strata, unit_scaling
from wct_plugin.mesh.repairs import Repairs
from wct_plugin.mesh.strata import PLACES
from wct_plugin.meshing.local_tolerance import describe as describe_tolerance
from wct_plugin.obstructions import remaining_tets
from wct_plugin.obstructions.remaining_tets import Remaining

#: Bin edges of the histograms: smallest h/R of a tet, its largest face angle, all its dihedral angles, its R/l, where
#: the last bin holds all that is larger too.
BINS = {
    "h/R": np.linspace(-1.0, 1.0, 41),
    "face_angle": np.linspace(60.0, 180.0, 41),
    "dihedral_angle": np.linspace(0.0, 180.0, 37),
    "R/l": np.linspace(0.6, 3.0, 49),
}
TITLES = {
    "h/R": "Smallest h/R of each tet",
    "face_angle": "Largest face angle of each tet",
    "dihedral_angle": "Dihedral angles",
    "R/l": "R/ℓ of each tet",
}
_MEASURES = {"h/R": "h/R", "face_angle": "Face angle", "dihedral_angle": "Dihedral angle", "R/l": "R/ℓ"}
_FLAGS = {"3wc": "3WC", "2wc": "2WC", "cwc": "CWC", "acute": "Acute"}
_TIER_NOTES = (
    "every volume positive, no two tets overlap",
    "no vertex inside a neighbour's circumsphere",
    "every dual edge positive, hence all duals inside",
    "every tet contains its circumcenter",
    "and every triangle acute",
)


@dataclass(frozen=True)
class WorstTet:
    """One of the tets that are farthest from being completely well-centered. Angles in degrees."""

    tet: int  #: index into the mesh's tets
    region: int
    min_height: float  #: smallest h/R
    max_face_angle: float
    min_dihedral_angle: float
    max_dihedral_angle: float
    place: str  #: highest stratum among its vertices, one of :data:`wct_plugin.mesh.strata.PLACES`
    centroid: tuple[float, float, float]


@dataclass(frozen=True)
class Report:
    """Statistics of one mesh, see :func:`make_report`."""

    source: str
    points: int
    tets: int
    regions: Mapping[int, int]  #: region tag -> number of tets
    boundary_facets: int
    components: int  #: parts that no facet joins
    joints: Joints  #: where the boundary meets itself
    coincident: Coincident  #: points where others are
    repairs: Repairs
    volume: float
    ranges: Mapping[str, tuple[float, float]]  #: min and max of h/R, face_angle, dihedral_angle (degrees), R/l
    flags: Mapping[str, int]  #: number of tets that are 3wc, 2wc, cwc, acute
    tiers: duals.Tiers
    negative_duals: NegativeDuals
    solver_view: SolverView
    histograms: Mapping[str, NDArray[np.int64]]  #: counts in :data:`BINS`
    worst: tuple[WorstTet, ...]  #: worst first, by the smaller of min h/R and the cosine of the largest face angle
    bad_by_place: Mapping[str, tuple[int, int, int]]  #: place -> tets there, those not 3WC, those not CWC
    deviation: Mapping[str, float] | None  #: of the boundary from the reference, in :mod:`wct_plugin.measure.deviation`
    tolerance: float | None = None  #: what the filter that made the mesh allowed of it, as a fraction of the diagonal
    local_tolerance: Mapping[str, Any] | None = None  #: the smallest of any place and where, if less than that
    remaining: Remaining | None = None  #: the tets that miss the goal of the filter that made the mesh
    shape: ShapeFloor | None = None  #: which of its flat tets the input's creases and corners force
    certificate: Certificate | None = None  #: what is proven exactly, if that was asked for
    other_cells: Mapping[str, int] = field(default_factory=dict)  #: those with a volume beside the tets, by kind
    notes: tuple[str, ...] = ()  #: lines about flat tets and about regions, where there is something to say

    def __repr__(self) -> str:
        return f"<Report {self.headline()}>"

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers, strings, lists and dicts in full precision; None where a value is not finite."""
        out: dict[str, Any] = {
            "source": self.source,
            "points": self.points,
            "tets": self.tets,
            "regions": {str(tag): count for tag, count in self.regions.items()},
            "boundary_facets": self.boundary_facets,
            "components": self.components,
            "joints": self.joints,
            "coincident": self.coincident,
            "other_cells": dict(self.other_cells),
            "repairs": vars(self.repairs),
            "volume": self.volume,
            "ranges": {name: {"min": low, "max": high} for name, (low, high) in self.ranges.items()},
        }
        for name, count in self.flags.items():
            out[name] = {"count": count, "percent": 100.0 * count / self.tets}
        out["tier"] = self.tiers.name
        out["tiers"] = {name: rank <= self.tiers.reached for rank, name in enumerate(duals.TIERS)}
        out["negative_duals"] = self.negative_duals.to_dict()
        out["solver_view"] = self.solver_view.to_dict()
        out["histograms"] = {
            name: {"edges": BINS[name].tolist(), "counts": counts.tolist()} for name, counts in self.histograms.items()
        }
        out["worst"] = [{**vars(tet), "centroid": list(tet.centroid)} for tet in self.worst]
        out["bad_by_place"] = {
            name: dict(zip(("tets", "not_3wc", "not_cwc"), counts, strict=True))
            for name, counts in self.bad_by_place.items()
        }
        out |= {
            "deviation": self.deviation,
            "tolerance": self.tolerance,
            "local_tolerance": self.local_tolerance,
            "remaining": self.remaining,
            "shape": self.shape,
            "certificate": self.certificate.to_dict() if self.certificate else None,
        }
        finite: dict[str, Any] = _finite(out)
        return finite

    def headline(self) -> str:
        """One line: what the mesh is and how far up the tiers it gets."""
        name = self.source or "mesh"
        beside = " and ".join(f"{count} {kind}" for kind, count in self.other_cells.items())
        return f"{name}: {self.tets} tets, {self.points} points, {_percent(self.flags['3wc'], self.tets)} 3WC, " + (
            f"{_percent(self.flags['cwc'], self.tets)} CWC, tier {self.tiers.name}"
            + (f"; the tets alone, without the {beside} cells beside them" if beside else "")
        )

    def rows_ranges(self) -> list[tuple[str, str, str]]:
        """Measure, min, max, formatted as the paper prints them."""
        return [(_MEASURES[name], _show(name, low), _show(name, high)) for name, (low, high) in self.ranges.items()]

    def rows_flags(self) -> list[tuple[str, str, str]]:
        """Flag, number of tets, percent."""
        return [(_FLAGS[name], str(count), _percent(count, self.tets)) for name, count in self.flags.items()]

    def rows_tiers(self) -> list[tuple[str, str, str]]:
        """Tier, yes or no, what it means."""
        return [
            (name, "yes" if rank <= self.tiers.reached else "no", _TIER_NOTES[rank])
            for rank, name in enumerate(duals.TIERS)
        ]

    def rows_places(self) -> list[tuple[str, str, str, str]]:
        """Place, tets there, those not 3WC, those not CWC."""
        return [(name, str(tets), str(no3), str(no)) for name, (tets, no3, no) in self.bad_by_place.items()]

    def worst_line(self) -> str:
        """The worst tet in one line."""
        tet = self.worst[0]
        place = ", ".join(f"{x:.4g}" for x in tet.centroid)
        angle = _show("face_angle", tet.max_face_angle)
        return f"worst: tet {tet.tet} ({tet.place}) near ({place}), min h/R {tet.min_height:.3f}, face angle {angle}"

    def worst_head(self) -> tuple[str, ...]:
        """Column names of :meth:`rows_worst`."""
        return ("tet", "region", "min h/R", "max face angle", "dihedral angles", "place", "centroid")

    def rows_worst(self) -> list[tuple[str, ...]]:
        """The worst tets, worst first."""
        return [
            (
                str(tet.tet),
                str(tet.region),
                _show("h/R", tet.min_height),
                _show("face_angle", tet.max_face_angle),
                f"{_show('dihedral_angle', tet.min_dihedral_angle)} - "
                f"{_show('dihedral_angle', tet.max_dihedral_angle)}",
                tet.place,
                "(" + ", ".join(f"{x:.4g}" for x in tet.centroid) + ")",
            )
            for tet in self.worst
        ]

    def rows_summary(self) -> list[tuple[str, str]]:
        """The same few lines for every mesh, to set two of them side by side."""
        ranges = {name: (low, high) for name, low, high in self.rows_ranges()}
        return [
            ("points", str(self.points)),
            ("tets", str(self.tets)),
            *((name, percent) for name, _, percent in self.rows_flags()),
            ("tier", self.tiers.name),
            *((f"{name}, {end}", row[k]) for name, row in ranges.items() for k, end in enumerate(("min", "max"))),
            *zip(solver_view.QUANTITIES, self.solver_view.total.shown(), strict=True),
            ("volume", f"{self.volume:.6g}"),
            ("deviation / diagonal", f"{self.deviation['fraction_of_diagonal']:.2e}" if self.deviation else "-"),
        ]

    def left(self, most: int = 10) -> tuple[str, tuple[str, ...], list[tuple[str, ...]]] | None:
        """Title, column names and up to ``most`` rows about the tets that miss the goal; None where none does."""
        if not self.remaining or not self.remaining["count"]:
            return None
        listed = remaining_tets.rows(self.remaining, most)
        rest = self.remaining["count"] - len(listed)
        title = remaining_tets.title(self.remaining) + (f"; the worst {len(listed)} of them" if rest else "")
        return title, remaining_tets.HEAD, listed

    def why(self) -> list[str]:
        """Why tets that miss the goal provably do so under the options given, one line per kind of reason."""
        return remaining_tets.lines(self.remaining) if self.remaining else []


def short_names(reports: Sequence[Report]) -> list[str]:
    """What to call each beside the others: its number and file, for the same name may be in two folders."""
    return [f"{number}: {PurePath(one.source).name or 'mesh'}" for number, one in enumerate(reports, start=1)]


def make_report(
    mesh: TetMesh, worst: int = 10, found: Mapping[str, Any] | None = None, *, exact: bool = False
) -> Report:
    """Measure a mesh: sizes, ranges, flags, tiers, histograms, its ``worst`` tets, deviation from its reference.

    ``found``: metrics of the filter that made it; its deviation, remaining tets and shape are not measured again.
    ``exact``: prove what is said about it, too, see :func:`wct_plugin.certify.certificate.certify`.
    Raises :class:`wct_plugin.errors.InputError` where three or more tets share a facet, and for sizes that
    :func:`wct_plugin.mesh.unit_scaling.check` refuses.
    """
    unit_scaling.check(mesh)
    measured = compiled_quality.measure(mesh)
    places = strata.places_of(mesh, strata.find_strata(mesh))
    flags = {
        "3wc": measured.well_centered_3,
        "2wc": measured.well_centered_2,
        "cwc": measured.completely_well_centered,
        "acute": measured.acute,
    }
    ranges = {
        "h/R": (measured.min_height, measured.max_height),
        "face_angle": (measured.min_face_angle, measured.max_face_angle),
        "dihedral_angle": (measured.min_dihedral_angle, measured.max_dihedral_angle),
        "R/l": (measured.radius_over_edge, measured.radius_over_edge),
    }
    tags, counts = np.unique(mesh.regions, return_counts=True)
    all_tets, *bad = (
        np.bincount(places[mask], minlength=len(PLACES)) for mask in (slice(None), ~flags["3wc"], ~flags["cwc"])
    )
    found = found or {}
    joints, coincident = count_joints(mesh), count_coincident(mesh)
    dual = duals.compute_duals(mesh)
    return Report(
        source=mesh.source,
        points=len(mesh.points),
        tets=len(mesh.tets),
        regions={int(tag): int(count) for tag, count in zip(tags, counts, strict=True)},
        boundary_facets=len(mesh.topology.boundary),
        components=int(mesh.topology.components.max()) + 1,
        joints=joints,
        coincident=coincident,
        other_cells=mesh.others.volumes if mesh.others else {},
        repairs=mesh.repairs,
        volume=float(measured.volume.sum()),
        ranges={name: (float(low.min()), float(high.max())) for name, (low, high) in ranges.items()},
        flags={name: int(mask.sum()) for name, mask in flags.items()},
        tiers=duals.tiers(mesh, measured),
        negative_duals=count_negative_duals(mesh, dual),
        solver_view=solver_view.view(mesh, dual),
        histograms=_histograms(mesh, measured),
        worst=_worst(mesh, measured, places, worst),
        bad_by_place={name: (int(all_tets[k]), int(bad[0][k]), int(bad[1][k])) for k, name in enumerate(PLACES)},
        deviation=found.get("deviation") or _deviation(mesh),
        tolerance=found.get("tolerance"),
        local_tolerance=found.get("local_tolerance"),
        remaining=found.get("remaining"),
        shape=found.get("shape"),
        certificate=certificate.certify(mesh) if exact else None,
        notes=_notes(found, joints, coincident, fidelity.region_names(mesh)),
    )


def _histograms(mesh: TetMesh, measured: Quality) -> dict[str, NDArray[np.int64]]:
    return {
        "h/R": _counts("h/R", measured.min_height),
        "face_angle": _counts("face_angle", measured.max_face_angle),
        "dihedral_angle": compiled_quality.dihedral_counts(mesh, BINS["dihedral_angle"]),
        "R/l": _counts("R/l", measured.radius_over_edge),
    }


def _notes(
    found: Mapping[str, Any], joints: Joints, coincident: Coincident, names: Mapping[str, str]
) -> tuple[str, ...]:
    lines = (
        describe_coincident(coincident),
        describe_joints(joints),
        "the mesh meets the goal already; it stays as it is (--force makes it anew)" if found.get("kept") else "",
        shape_floor.describe(found["shape"]) if "shape" in found else "",
        fidelity.describe(found["volumes"], found.get("interfaces", {}), names) if "volumes" in found else "",
        released_creases.describe(found["released"]) if "released" in found else "",
        pinned.describe(found["pinned"]) if "pinned" in found else "",
        planes.describe(found["planes"]) if found.get("planes") else "",
        _pairs(found["periodic"]) if found.get("periodic") else "",
        describe_tolerance(found["tolerance"], bool(found.get("default_tolerance")), found.get("local_tolerance"))
        if "tolerance" in found
        else "",
    )
    return tuple(filter(None, lines))


def _pairs(found: Mapping[str, int]) -> str:
    """What is said of sides that are translates of each other."""
    before, after = found["before"], found["after"]
    if after >= before:
        return f"{after} pair{'' if after == 1 else 's'} of sides match, vertex for vertex"
    count = f"{before} pair{'' if before == 1 else 's'} of sides matched"
    return f"{count}, vertex for vertex; {after} do now (--periodic keeps them)"


def _deviation(mesh: TetMesh) -> dict[str, float] | None:
    if mesh.reference is None or not mesh.reference.diagonal:
        return None
    unit_scaling.check_reference(mesh.reference, mesh)
    return measure_deviation(mesh.boundary_surface(), mesh.reference).to_dict(mesh.reference.diagonal)


def _counts(name: str, values: NDArray[np.float64]) -> NDArray[np.int64]:
    """Every value in a bin: those beyond the ends in the outermost, what is no number in a flat tet with the worst."""
    bins = BINS[name]
    worst = bins[0] if name == "h/R" else bins[-1]
    return np.histogram(np.clip(np.nan_to_num(values, nan=worst), bins[0], bins[-1]), bins)[0].astype(np.int64)


def _worst(mesh: TetMesh, measured: Quality, places: NDArray[np.int8], count: int) -> tuple[WorstTet, ...]:
    margin = np.minimum(measured.min_height, np.cos(np.radians(measured.max_face_angle)))
    order = np.argsort(np.nan_to_num(margin, nan=-np.inf), kind="stable")[:count]
    centroids = mesh.points[mesh.tets[order]].mean(axis=1)
    return tuple(
        WorstTet(
            int(tet),
            int(mesh.regions[tet]),
            float(measured.min_height[tet]),
            float(measured.max_face_angle[tet]),
            float(measured.min_dihedral_angle[tet]),
            float(measured.max_dihedral_angle[tet]),
            PLACES[places[tet]],
            (float(x), float(y), float(z)),
        )
        for tet, (x, y, z) in zip(order, centroids, strict=True)
    )


def _show(measure: str, value: float) -> str:
    if not math.isfinite(value):
        return "-"
    return f"{value:.3f}" if measure in ("h/R", "R/l") else f"{value:.2f}°"


def _percent(count: int, total: int) -> str:
    """To three decimals, but 100.000 and 0.000 only where that is exact."""
    thousandths = round(100_000 * count / total)
    if 0 < count < total:
        thousandths = min(max(thousandths, 1), 99_999)
    return f"{thousandths / 1000:.3f} %"


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
