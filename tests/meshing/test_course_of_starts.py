"""Which start the search goes on from, and with how much of the work, by how many tets the ones before left stuck."""

import numpy as np
import pytest
from support.builders import two_region_cube

from wct_plugin.core.results import SearchResult
from wct_plugin.meshing import search_mesh
from wct_plugin.meshing.local_search import LocalSearch
from wct_plugin.meshing.local_tolerance import Tolerance
from wct_plugin.meshing.phase_progress import Listener
from wct_plugin.meshing.reference import own_boundary
from wct_plugin.meshing.surface_edges import Lengths
from wct_plugin.meshing.tet_limit import TetLimit
from wct_plugin.meshing.work_limit import WorkLimit

NONE = np.empty(0, dtype=np.int64)
MESH = two_region_cube(8)
OWN = own_boundary(MESH, 40.0)
START = search_mesh.from_mesh(MESH, OWN, pinned=False)
TETS = len(MESH.tets)
AT_CORNERS = (START.stratum[START.tets] == 3).any(axis=1)


class Scripted(LocalSearch):
    """Searches leave as many tets stuck as is written down, in that order, and every start can be made."""

    def follow(self, stuck, *, layers=False, at_corners=True):
        """What is done: searches by the part of the work, starts by their kind; and how many results there are.

        ``layers``: whether there are any with one row of tets, through which three may go. ``at_corners``: whether it
        is there that tets are stuck, as long as there are any.
        """
        object.__setattr__(self, "rows", np.argsort(at_corners != AT_CORNERS, kind="stable"))
        object.__setattr__(self, "script", list(stuck))
        object.__setattr__(self, "layers", layers)
        object.__setattr__(self, "course", [])
        results = self.run_finer(START, OWN, Tolerance(1e-3), Lengths())
        assert not self.script
        return self.course, len(results)

    def run(self, start, on, tolerance, worth=np.inf, part=1.0):
        kind = "search" if worth == self.worth else "longer" if worth < np.inf else "on"
        self.course.append((kind, part))
        bad = self.script.pop(0)
        self.work.add_search(1, stuck=bad)
        return SearchResult(START, bad, self.rows[:bad], 0.0, 0, 0, 0, 0, 1, stopped=False, released=NONE)

    def resampled(self, on, tolerance, lengths, finer=None, restart=None, attempt=0):
        if not lengths.one_row:
            if self.layers:
                self.course.append(("rows", 0 if finer is None else len(finer.at)))
            return START if self.layers else None
        self.course.append(("whole" if restart is None else "partial", len(finer.at)))
        return START


@pytest.fixture
def search():
    listen = Listener(lambda _: True, 0)
    return Scripted(MESH, "move", True, 0.02, 1, 0, listen, TetLimit(None, TETS, listen), WorkLimit(TETS, 1))


def test_what_comes_right_at_once_is_all(search):
    assert search.follow([0]) == ([("search", 1.0)], 1)


def test_a_whole_start_follows_most_of_the_work(search):
    course, results = search.follow([20, 4, 0])
    assert course == [("search", 1.0), ("on", 0.75), ("whole", 4), ("search", 1.0)]
    assert results == 3


def test_a_spoilt_one_is_dropped_and_the_best_goes_on(search):
    course, _ = search.follow([20, 4, 13, 0])
    assert course[-2:] == [("search", 1.0), ("on", 1.0)]


def test_one_that_is_little_worse_is_followed_by_parts_made_anew(search):
    course, _ = search.follow([20, 4, 12, 0])
    assert course[4] == ("partial", 8)  # shorter edges at the four of both times


def test_few_that_are_stuck_are_made_anew_in_parts(search):
    course, _ = search.follow([3, 3, 0])
    assert course == [("search", 1.0), ("longer", 0.4), ("partial", 3), ("search", 1.0)]


def test_where_many_are_stuck_a_finer_start_is_tried_first(search):
    course, _ = search.follow([TETS // 40, 10, 0])
    assert course[:3] == [("search", 1.0), ("whole", TETS // 40), ("search", 1.0)]
    assert course[3:] == [("on", 0.75)]


def test_where_corners_of_layers_are_stuck_more_rows_are_tried_first(search):
    course, results = search.follow([20, 0], layers=True)
    assert course == [("search", 1.0), ("rows", 0), ("search", 1.0)]
    assert results == 2


def test_the_better_of_one_row_and_three_goes_on(search):
    course, _ = search.follow([20, 4, 4, 0], layers=True)
    assert course[3:] == [("longer", 0.4), ("rows", 4), ("search", 1.0)]
    course, _ = search.follow([20, 21, 0], layers=True)
    assert course[3:] == [("on", 1.0)]  # with one row


def test_what_is_stuck_off_corners_needs_no_more_rows(search):
    course, _ = search.follow([20, 4, 0], layers=True, at_corners=False)
    assert course == [("search", 1.0), ("on", 0.75), ("whole", 4), ("search", 1.0)]
