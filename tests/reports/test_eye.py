"""Meshes stand upright in their pictures."""

from dataclasses import replace

import numpy as np
import pytest
from support.builders import ball, bcc, single, two_region_cube

from wct_plugin.reports.eye import Eye

#: A pyramid with its base at y = 0.
ON_Y = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.0, 1.0], [0.5, 1.0, 0.4]]


def stretched(mesh, *by):
    return replace(mesh, points=mesh.points * np.array(by))


@pytest.mark.parametrize(
    ("mesh", "upward"),
    [
        (bcc(2), "z"),
        (stretched(two_region_cube(2), 1.0, 5.0, 1.0), "z"),  # it stands on z too, a beam that lies
        (ball(3), "z"),
        (stretched(ball(3), 1.0, 2.0, 1.0), "y"),
        (stretched(ball(3), 2.0, 2.0, 1.0), "z"),
        (single(ON_Y), "y"),
        (single(np.array(ON_Y)[:, [0, 2, 1]]), "z"),
        (single(np.array(ON_Y) * 1e-9 + 5.0), "y"),
    ],
)
@pytest.mark.parametrize("behind", [False, True])
def test_what_is_up_is_up(mesh, upward, behind):
    eye = Eye.of(mesh, behind)
    assert eye.upward == upward
    assert np.allclose(eye.axes @ eye.axes.T, np.eye(3))
    assert np.linalg.det(eye.axes) == pytest.approx(1.0)
    axis = "xyz".index(upward)
    assert eye.axes[0, axis] == pytest.approx(0.0)
    assert eye.axes[1, axis] > 0.9
    assert (eye.axes[2, axis] > 0) != behind
