"""What pymeshlab's filters take, asked of pymeshlab itself, in the child of :mod:`.run`.

pymeshlab casts, cuts to the range or ignores what does not fit, and its errors do not say what would. Here every
argument is checked by name, type, choice and range before anything runs.
"""

import ctypes
import difflib
import math
import os
import re
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pymeshlab

from wct_plugin.errors import OptionError

_PARAMETER = re.compile(r"^\t(\w+) : (.+?) = ")
_POINT, _MATRIX = "numpy.ndarray[numpy.float64[3]]", "numpy.ndarray[numpy.float64[4, 4]]"
_BOUNDED, _ENUM = "float (bounded)", "enum"
_ALLOWED = {
    "bool": "true or false",
    "int": "an integer of 32 bits",
    "float": "a number",
    _BOUNDED: "a number",
    "str": "a text",
    _ENUM: "the name of a choice, or its number",
    "PercentageValue": "a number in the mesh's unit, or a text of 0 to 100 %, like '1%'",
    "Color": "a list [red, green, blue] or [red, green, blue, alpha] of integers 0..255",
    _POINT: "a list of 3 numbers",
    _MATRIX: "a list of 4 lists of 4 numbers",
}
#: Parameters that name a file, which the filter reads or writes; one without folders is in a temporary folder.
_FILES = ("textname", "texturename", "csvfilename")
#: Filters that send the mesh elsewhere.
_SENDING = ("export_mesh_to_sketchfab",)
#: Display names that MeshLab and pymeshlab have changed since pymeshlab's own list of old names was written.
_RENAMED = {
    "alpha_wrap": "generate_alpha_wrap",
    "colorize_by_approximated_geodesic_distance_from_the_selected_points": (
        "compute_scalar_by_heat_geodesic_distance_from_selection_per_vertex"
    ),
    "compute_ambient_occlusion": "compute_scalar_ambient_occlusion",
    "compute_obscurance": "compute_scalar_by_volumetric_obscurance",
    "compute_shape_diameter_function": "compute_scalar_by_shape_diameter_function_per_vertex",
    "cubic_stylization": "apply_coord_cubic_stylization",
    "dodecahedron_symmetric": "create_dodecahedron_sym",
    "harmonic_parametrization": "compute_texcoord_parametrization_harmonic",
    "least_squares_conformal_maps_parametrization": ("compute_texcoord_parametrization_least_squares_conformal_maps"),
    "make_mesh_developable": "apply_coord_developability_of_mesh",
    "per_face_normal_function": "compute_normal_by_function_per_face",
    "re_orient_all_faces_coherently": "meshing_re_orient_faces_coherently",
    "reorient_face_normals_by_geometry": "meshing_re_orient_faces_by_geometry",
    "subdivision_surfaces_doo_sabin": "meshing_surface_subdivision_doo_sabin",
}


class Catalogue:
    """Names of the filters and kinds of their parameters."""

    def __init__(self) -> None:
        self.filters: list[str] = sorted(pymeshlab.filter_list())

    def find(self, step: dict[str, Any]) -> str:
        """What pymeshlab calls a step's filter."""
        name: str = step["filter"]
        known = {_spelled(old): new for old, new in _old_names().items()} if step["from_script"] else {}
        found = known.get(_spelled(name)) if step["from_script"] else name
        if step["from_script"] and found in _SENDING:
            raise OptionError(f"{step['where']}: sends the mesh to a server, which no script may ask for")
        if found in self.filters:
            return found
        near = difflib.get_close_matches(_spelled(name), [*known, *self.filters], 1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        raise OptionError(f"{step['where']}: MeshLab has no such filter{hint}")

    def kinds(self, name: str) -> dict[str, str]:
        """The kind of each parameter of a filter, as pymeshlab prints it, and ``enum``."""
        listing = _printed(pymeshlab.print_filter_parameter_list, name)
        return {match[1]: match[2] for line in listing.splitlines() if (match := _PARAMETER.match(line))}

    def arguments(self, name: str, step: dict[str, Any], probes: Sequence[pymeshlab.MeshSet]) -> dict[str, Any]:
        """The step's arguments as pymeshlab takes them; those out of range for all the probes are refused."""
        kinds = self.kinds(name)
        defaults = probes[0].filter_parameter_values(name)
        out = {}
        for given, value in step["arguments"].items():
            where = f"{step['where']}: argument {given!r}"
            key = _parameter(given) if step["from_script"] else given
            if key not in kinds:
                near = difflib.get_close_matches(key, kinds, 1)
                hint = f"; did you mean {near[0]!r}?" if near else ""
                raise OptionError(f"{where} is unknown{hint} (allowed: {', '.join(kinds) or 'none'})")
            kind = kinds[key]
            if kind == "str" and isinstance(defaults[key], int):
                kind = _ENUM
            try:
                plain = _from_text(kind, value) if step["from_script"] else value
                out[key] = _converted(kind, plain)
            except (TypeError, ValueError, OverflowError) as error:
                allowed = _ALLOWED.get(kind, "nothing: pymeshlab cannot set it")
                raise OptionError(f"{where} is {_shown(value)}; allowed is {allowed}") from error
            if step["from_script"] and key in _FILES and set("/\\") & set(out[key]):
                raise OptionError(
                    f"{where} is {_shown(value)}; allowed in a script is the name of a file without folders"
                )
            _check(name, key, out[key], kind, probes, f"{where} is {_shown(value)}")
        return out


def _shown(value: Any) -> str:
    """A value as the user wrote it, cut to a line."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 60 else f"{text[:57]}..."


def _spelled(display: str) -> str:
    """A name as pymeshlab once made its names from MeshLab's display names."""
    return re.sub(r"[^a-z0-9]+", "_", display.lower()).strip("_")


def _parameter(name: str) -> str:
    """What pymeshlab calls a script's parameter."""
    spelled = re.sub(r"[^a-z0-9]+", "_", name.lower())
    return f"{spelled}_" if spelled == "lambda" else spelled


def _old_names() -> dict[str, str]:
    """Names made from display names, and what pymeshlab calls these filters now."""
    listing = Path(pymeshlab.__file__).with_name("keys.txt").read_text(encoding="utf-8")
    pairs = [line.split() for line in listing.splitlines()]
    return {pair[0]: pair[1] for pair in pairs if len(pair) == 2} | _RENAMED


def _printed(call: Callable[..., object], *arguments: object) -> str:
    """What native code prints."""
    with tempfile.TemporaryFile() as file:
        sys.stdout.flush()
        keep = os.dup(1)
        os.dup2(file.fileno(), 1)
        try:
            call(*arguments)
            ctypes.CDLL("ucrtbase" if sys.platform == "win32" else None).fflush(None)
        finally:
            os.dup2(keep, 1)
            os.close(keep)
        file.seek(0)
        return file.read().decode(errors="replace")


def _from_text(kind: str, raw: Any) -> Any:
    """A script's text, or list of texts, as the plain value it stands for."""
    match kind:
        case "bool":
            return {"true": True, "false": False}.get(raw, raw)
        case "int":
            return int(raw)
        case "float" | "float (bounded)" | "PercentageValue":
            return float(raw)
        case "enum":
            return int(raw) if raw.lstrip("-").isdigit() else raw
        case "Color":
            return [int(each) for each in raw]
        case "numpy.ndarray[numpy.float64[3]]":
            return [float(each) for each in raw]
        case "numpy.ndarray[numpy.float64[4, 4]]":
            return [[float(each) for each in raw[row : row + 4]] for row in range(0, 16, 4)]
        case _:
            return raw


def _converted(kind: str, value: Any) -> Any:
    """A plain value as pymeshlab takes it. Raises TypeError, ValueError or OverflowError where it does not fit."""
    match kind:
        case "bool":
            return _a(bool, value)
        case "int":
            return _within(_an_int(value), -(2**31), 2**31 - 1)
        case "enum":
            return value if isinstance(value, str) else _an_int(value)
        case "float" | "float (bounded)":
            return _a_float(value)
        case "str":
            return _a(str, value)
        case "PercentageValue" if isinstance(value, str):
            if not value.endswith("%"):
                raise ValueError(value)
            return pymeshlab.PercentageValue(_within(_a_float(float(value[:-1])), 0.0, 100.0))
        case "PercentageValue":
            return pymeshlab.PureValue(_a_float(value))
        case "Color":
            bands = [_within(_an_int(band), 0, 255) for band in _a(list, value)]
            if len(bands) not in (3, 4):
                raise ValueError(value)
            return pymeshlab.Color(*bands, *[255] * (4 - len(bands)))
        case "numpy.ndarray[numpy.float64[3]]":
            return _row(value, 3)
        case "numpy.ndarray[numpy.float64[4, 4]]":
            rows = [_row(row, 4) for row in _a(list, value)]
            if len(rows) != 4:
                raise ValueError(value)
            return rows
        case _:
            raise TypeError(kind)


def _a(kind: type, value: Any) -> Any:
    if not isinstance(value, kind):
        raise TypeError(value)
    return value


def _an_int(value: Any) -> int:
    if isinstance(value, bool):
        raise TypeError(value)
    number: int = _a(int, value)
    return number


def _a_float(value: Any) -> float:
    number = value if isinstance(value, float) else float(_an_int(value))
    if not math.isfinite(number):
        raise ValueError(value)
    return number


def _within(value: Any, low: float, high: float) -> Any:
    if not low <= value <= high:
        raise ValueError(value)
    return value


def _row(value: Any, count: int) -> list[float]:
    row = [_a_float(each) for each in _a(list, value)]
    if len(row) != count:
        raise ValueError(value)
    return row


def _check(name: str, key: str, value: Any, kind: str, probes: Sequence[pymeshlab.MeshSet], what: str) -> None:
    """Choices and ranges: pymeshlab refuses a wrong choice, and cuts a number to its range without a word."""
    try:
        taken = [probe.filter_parameter_values(name, **{key: value})[key] for probe in probes]
    except pymeshlab.InvalidEnumException as error:
        raise OptionError(f"{what}; allowed is one of {_choices(name, key, probes[0])}") from error
    except Exception as error:  # a parameter pymeshlab checks in ways of its own
        raise OptionError(f"{what}; pymeshlab refuses it: {' '.join(str(error).split())}") from error
    if kind != _BOUNDED or not all(math.isclose(each, taken[0], rel_tol=1e-5) for each in taken):
        return
    if not math.isclose(taken[0], value, rel_tol=1e-5, abs_tol=1e-30):
        side = "at most" if value > taken[0] else "at least"
        raise OptionError(f"{what}; allowed is {side} {taken[0]:g}")


def _choices(name: str, key: str, probe: pymeshlab.MeshSet) -> str:
    """The names of a parameter's choices: pymeshlab tells them where a text is none of them."""
    try:
        probe.filter_parameter_values(name, **{key: ""})
    except pymeshlab.InvalidEnumException as error:
        return ", ".join(re.findall(r"'[^']*'(?=; )", str(error)))
    return "its names"
