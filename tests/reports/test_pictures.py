"""The report's pictures: what is in front is what is seen, and colours say what they should."""

from dataclasses import replace
from io import BytesIO

import numpy as np
from PIL import Image
from support.builders import bcc, jittered_cube, kuhn_cube, single

from wct_plugin.measure.quality import measure
from wct_plugin.mesh import TetMesh
from wct_plugin.reports.colour_scales import OBTUSE, colours
from wct_plugin.reports.pictures import pictures


def pixels(picture):
    """(h, w, 4) in 0..1."""
    with Image.open(BytesIO(picture.png)) as image:
        assert image.size == picture.size
        return np.asarray(image.convert("RGBA")) / 255.0


def luminance(rgb):
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    return linear @ [0.2126, 0.7152, 0.0722]


def share(picture, colour, off=0.06):
    """Of what is drawn, how much has the colour, lit or in the shade."""
    image = pixels(picture)
    drawn = image[image[..., 3] > 0.9][:, :3]
    direction = np.asarray(colour) / np.linalg.norm(colour)
    apart = np.linalg.norm(drawn / np.maximum(np.linalg.norm(drawn, axis=1, keepdims=True), 1e-9) - direction, axis=1)
    return float((apart < off).mean())


def test_bad_is_darker_than_good_without_any_colour():
    """In grey, in print and to any eye, also with the darkest shade on what is good."""
    bad = luminance(colours(np.linspace(-1.0, 0.0, 50)))
    good = luminance(colours(np.linspace(1e-9, 1.0 / 3.0, 50)))
    shaded = luminance(0.72 * colours(np.linspace(1e-9, 1.0 / 3.0, 50)))
    assert max(bad.max(), luminance(np.array(OBTUSE))) < min(0.5 * good.min(), shaded.min())
    assert (np.diff(bad) > 0).all()
    assert (colours(np.array([np.nan])) == colours(np.array([-1.0]))).all()
    assert np.allclose(colours(np.array([0.0])), colours(np.array([-1e-9])))  # not above zero is not inside


def test_a_good_mesh_is_light_and_has_no_inside():
    front, back = pictures(bcc(2))
    assert len(front) == len(back) == 1
    for (picture,) in (front, back):
        image = pixels(picture)
        seen = image[image[..., 3] > 0.9][:, :3]
        assert 0.1 < len(seen) / image[..., 0].size < 0.9
        assert np.median(luminance(seen)) > 0.25
        assert "0 of " in picture.alt
        assert (image[[0, -1, 0, -1], [0, 0, -1, -1], 3] == 0).all()  # the ground is the page's


REGULAR = np.array([[1, 1, 1], [-1, 1, -1], [1, -1, -1], [-1, -1, 1]])
SIDE = np.array([1.0, 0.0, 0.0])
FLAT = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.3, 0.05]])


def tets(*corners):
    """Tets apart from each other."""
    return TetMesh(np.vstack(corners), np.arange(4 * len(corners)).reshape(-1, 4))


def test_the_nearer_hides_the_farther():
    """Of a small bad tet straight behind a large good one nothing is seen, but from the opposite side."""
    eye = np.array([np.cos(np.radians(-60.0)), np.sin(np.radians(-60.0)), np.tan(np.radians(25.0))])
    mesh = tets(3.0 * REGULAR, FLAT - FLAT.mean(axis=0) - 8.0 * eye, REGULAR + 12.0 * SIDE, REGULAR - 12.0 * SIDE)
    bad = colours(measure(mesh).min_height[1:2])[0]
    (front, _), (back, _) = pictures(mesh)
    assert share(front, bad) == 0.0
    assert share(back, bad) > 0.001


def test_what_is_bad_inside_is_seen_through_the_boundary():
    mesh = kuhn_cube(4)
    points = mesh.points.copy()
    centre = int(np.flatnonzero((points == 0.5).all(axis=1))[0])
    points[centre] += [0.12, 0.05, 0.02]
    mesh = replace(mesh, points=points)
    front, _ = pictures(mesh)
    boundary, inside = front
    measured = measure(mesh)
    assert f"{int((~measured.well_centered_3).sum())} tets do not contain" in inside.alt
    assert "transparent" in inside.caption
    assert 0 < np.mean(pixels(inside)[..., 3] > 0) < 1
    assert boundary.png != inside.png


def test_few_bad_tets_are_ringed():
    """However small: one bad tet far from a large good one is still found."""
    mesh = tets(100.0 * REGULAR, 250.0 * SIDE + FLAT)
    (boundary, inside), _ = pictures(mesh)
    ring = np.array([0xC4, 0x50, 0x0C]) / 255.0
    assert share(boundary, ring, 0.03) < 0.0005
    assert share(inside, ring, 0.03) > 0.002


def test_any_size_and_shape_gives_a_picture():
    for scale, shift in ((1e-9, 0.0), (1e9, 0.0), (1.0, 1e6)):
        for mesh in (jittered_cube(2), single([[0, 0, 0], [50, 0, 0], [0, 1, 0], [0, 0, 0.01]])):
            front, back = pictures(replace(mesh, points=mesh.points * scale + shift))
            assert all(np.any(pixels(picture)[..., 3] > 0) for picture in (*front, *back))


def test_drawing_leaves_no_trace_in_matplotlib():
    import matplotlib as mpl

    before = dict(mpl.rcParams)
    pictures(bcc(2))
    assert dict(mpl.rcParams) == before
