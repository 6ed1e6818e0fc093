"""Metrics print in short and are a dict in all else."""

import json
import pickle

import pytest
from support.builders import jittered_cube

import wct_plugin as wct
from wct_plugin.pipeline.short_metrics import ShortMetrics

CUBE = jittered_cube(3)


@pytest.mark.parametrize("name", ["get_quality", "compute_power_weights", "apply_coord_well_centering"])
def test_metrics_of_filters_print_in_short(name):
    _, metrics = wct.apply_filter(name, CUBE)
    plain = dict(metrics)
    assert len(repr(metrics)) < 500 < len(repr(plain))
    assert type(plain) is dict
    assert isinstance(metrics, dict)
    assert metrics == plain == json.loads(json.dumps(metrics)) == pickle.loads(pickle.dumps(metrics))


def test_what_is_said():
    found = ShortMetrics(
        {"bad": 0, "kept": False, "worst": -0.123456, "3wc": {"count": 5, "percent": 12.5}, "none": None, "empty": {},
         "source": "part.msh", "path": "x" * 40, "list": [1], "deviation": {"max": 1.0}}
    )  # fmt: skip
    assert repr(found) == (
        "<metrics: bad 0, kept no, worst -0.1235, 3wc 5 (12.5 %), source part.msh; more in path, list, deviation;"
        " dict(_) prints all>"
    )
    assert found["deviation"]["max"] == 1.0
    assert repr(ShortMetrics()) == "<metrics: no single numbers; dict(_) prints all>"
