"""The 3D view of a report: meshes to be turned, cut and sifted in the page itself, which loads nothing.

K3D draws. Its JavaScript comes out of its installed wheel; the controls in ``view.js`` decide what it draws. Without
JavaScript or WebGL the view gives way to one line, and the report's pictures show the meshes.
"""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from html import escape
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from wct_plugin.errors import how_to_install
from wct_plugin.mesh import TetMesh
from wct_plugin.reports import colour_scales
from wct_plugin.reports.colour_scales import Rgb, Stops, hexadecimal
from wct_plugin.reports.eye import Eye
from wct_plugin.reports.html_elements import Html, Script, paragraph, section
from wct_plugin.reports.view_data import MOST, Frame, Packed, Scale, compressed, pack
from wct_plugin.types import Floats, Ints

#: So many meshes are shown beside each other; a browser has only so many WebGL contexts.
_MOST_MESHES = 4
#: The camera sees so many degrees from below to above.
_DEGREES = 30.0
_OFF = "The 3D view needs JavaScript and WebGL 2; the pictures below show the same without."

STYLE = """
.view .controls, .view .stages { display: none; } .view.on .off { display: none; }
.view.on .controls { display: flex; flex-wrap: wrap; gap: .6rem 1.6rem; align-items: end; margin: .8rem 0; padding: 0;
  border: 0; }
.view.on .stages { display: grid; }
.view label { display: block; } .view .group { display: flex; flex-wrap: wrap; gap: .3rem .7rem; align-items: end; }
.view select, .view button { font: inherit; color: inherit; background: var(--panel); border: 1px solid var(--line);
  border-radius: .3rem; padding: .25rem .5rem; max-width: 100%; }
.view output { white-space: nowrap; } .view .slider { width: 9rem; min-height: 3rem; }
.view input[type=range] { width: 100%; accent-color: var(--good); vertical-align: middle; }
.view .stage { height: 27rem; border: 1px solid var(--line); border-radius: .5rem; overflow: hidden;
  position: relative; }
.view .legend { display: flex; flex-wrap: wrap; gap: .3rem .6rem; align-items: center; min-height: 2rem; }
.view .bar { flex: 1 1 8rem; max-width: 20rem; height: .9rem; border: 1px solid var(--line); }
.view .key { width: 1rem; height: 1rem; border: 1px solid var(--line); } .view .wide { flex-basis: 100%; }
@media (max-width: 42rem) { .view .stage { height: 20rem; } }
@media print { .view { display: none; } }
"""

_CONTROLS = """
<fieldset class="controls">
<label>Colour<br><select name="colour">{colours}</select></label>
<div class="group"><label>Cut across<br><select name="clip"><option value="">nothing</option>
<option value="0">x</option><option value="1">y</option><option value="2">z</option></select></label>
<div class="slider"><output for="place"></output><br><input type="range" name="place" id="place" min="0" max="1000"
value="500" aria-label="Where the cut is"></div>
<label><input type="checkbox" name="flip"> other side</label></div>
<div class="group"><label>Show<br><select name="threshold"><option value="">all tets</option>
<option value="height most">min h/R at most</option><option value="height least">min h/R at least</option>
<option value="angle most">face angle at most</option><option value="angle least">face angle at least</option></select>
</label><div class="slider"><output for="limit"></output><br><input type="range" name="limit" id="limit" min="0"
max="1000" value="500" aria-label="The limit"></div></div>
<div class="group"><label><input type="checkbox" name="alone"> bad tets alone</label>
<label><input type="checkbox" name="edges" checked> edges</label>
<button type="button" name="home">Reset the view</button></div>
</fieldset>
<div class="legend"></div>
"""
#: Files that K3D would fetch beside itself; the fonts that it needs are in it.
_FETCHED = re.compile(rb',url\(fonts/[^)]*\) format\("[a-z]+"\)')


@dataclass(frozen=True)
class View:
    """What goes into a page, and the script that the page must allow."""

    html: Html
    script: Script | None = None


@dataclass(frozen=True)
class Apart:
    """How far boundaries are from the reference."""

    facets: Sequence[Floats]  #: per mesh, (b,) as fractions of the diagonal
    stops: Stops
    tolerance: float | None


@cache
def library() -> str | None:
    """K3D's JavaScript, compressed and in base64; None where it is not installed."""
    found = find_spec("k3d")
    source = Path(str(found.origin)).parent / "static" / "standalone.js" if found and found.origin else None
    if source is None or not source.exists():
        return None
    return compressed(_FETCHED.sub(b"", source.read_bytes()))


def view(names: Sequence[str], meshes: Sequence[TetMesh], apart: Apart | None) -> View:
    """The meshes beside each other, turned and cut alike; the last one says how they stand."""
    code = library()
    if code is None:
        return View(paragraph(f"A view to turn and cut in 3D comes with: {how_to_install('view')}", "muted"))
    shown = [len(mesh.topology.boundary) <= MOST for mesh in meshes][:_MOST_MESHES]
    if not all(shown):
        said = f"There is no 3D view: the boundary alone has more than {MOST} triangles."
        return View(paragraph(said, "muted"))
    names, meshes = names[:_MOST_MESHES], meshes[:_MOST_MESHES]
    frame = Frame.of(meshes)
    stops: dict[str, Stops] = {"height": colour_scales.HEIGHT, "angle": colour_scales.ANGLE}
    if apart is not None:
        stops["deviation"] = apart.stops
    scales = {name: Scale(one[0][0], one[-1][0]) for name, one in stops.items()}
    tags = np.unique(np.concatenate([mesh.regions for mesh in meshes]))
    far = apart.facets if apart is not None else [None] * len(meshes)
    packed = [pack(mesh, frame, scales, tags, one) for mesh, one in zip(meshes, far, strict=False)]
    settings = _settings(meshes, frame, stops, tags) | {"meshes": [one.about for one in packed]}
    script = Script(files("wct_plugin.reports").joinpath("view.js").read_text(encoding="utf-8"))
    data = [_data("view-library", code), _data("view-settings", json.dumps(settings))]
    data += [_data(f"view-mesh-{k}", one.text) for k, one in enumerate(packed)]
    return View(section("In 3D", _markup(names, packed, stops), *data, script.html), script)


def _settings(meshes: Sequence[TetMesh], frame: Frame, stops: Mapping[str, Stops], tags: Ints) -> dict[str, Any]:
    eye = Eye.of(meshes[-1])
    inside = [frame.place(mesh.points) for mesh in meshes]
    words = {
        "height": ("−1", "⅓", "min h/R of each tet: orange to brown, below 0, its circumcenter is outside; violet: "
                   "it is inside, but a triangle is not acute"),
        "angle": ("60°", "180°", "largest angle in a triangle of each tet: orange to brown from 90° on"),
        "deviation": ("0", f"{stops.get('deviation', [(0.0, ())])[-1][0]:.2e}",
                      "distance of each boundary triangle from the reference, of the diagonal; grey inside"),
    }  # fmt: skip
    return {
        "scales": {
            name: {
                "low": one[0][0],
                "high": one[-1][0],
                "stops": [[at, _number(colour)] for at, colour in one],
                "say": words[name][:2],
                "words": words[name][2],
            }
            for name, one in stops.items()
        },
        "palette": [_number(colour) for colour in colour_scales.REGIONS],
        "obtuse": _number(colour_scales.OBTUSE),
        "regions": [f"region {tag}" for tag in tags[: len(colour_scales.REGIONS)]],
        "low": np.min([points.min(axis=0) for points in inside], axis=0).tolist(),
        "high": np.max([points.max(axis=0) for points in inside], axis=0).tolist(),
        "center": frame.center.tolist(),
        "size": frame.size,
        "eye": _eye(eye, np.concatenate(inside)),
    }


def _eye(eye: Eye, points: Floats) -> dict[str, Any]:
    """Right, up and away, the middle of what is seen and how far it reaches from there, and the camera's angle."""
    seen = eye.see(points)
    low, high = seen.min(axis=0), seen.max(axis=0)
    middle, reach = (low + high) / 2.0 @ eye.axes, (high - low) / 2.0
    return {
        "axes": eye.axes.tolist(),
        "middle": middle.tolist(),
        "reach": reach.tolist(),
        "degrees": _DEGREES,
        "up": eye.upward,
    }


def _markup(names: Sequence[str], packed: Sequence[Packed], stops: Mapping[str, Stops]) -> Html:
    titles = {"height": "min h/R", "angle": "largest face angle", "region": "region", "deviation": "deviation"}
    offered = [*("height", "angle", "region"), *(["deviation"] if "deviation" in stops else [])]
    colours = "".join(f'<option value="{name}">{titles[name]}</option>' for name in offered)
    stages = "".join(
        f'<figure><div class="stage"></div><figcaption>{escape(f"{name}. " if len(packed) > 1 else "")}'
        f"<output></output>{escape(f'. In the page are {one.note}.' if one.note else '')}</figcaption></figure>"
        for name, one in zip(names, packed, strict=True)
    )
    return Html(
        f'<div class="view" id="view"><p class="muted off">{_OFF}</p>{_CONTROLS.format(colours=colours)}'
        f'<div class="grid stages">{stages}</div></div>'
    )


def _data(name: str, text: str) -> Html:
    """Text for the script to read; nothing in it ends the element."""
    return Html(f'<script type="text/plain" id="{name}">{text.replace("<", chr(92) + "u003c")}</script>')


def _number(colour: Rgb) -> int:
    return int(hexadecimal(colour)[1:], 16)
