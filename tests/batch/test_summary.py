"""The table at a batch's end: its line of counts, and that failures stand last."""

from dataclasses import replace

import pytest

from wct_plugin.batch.job import Record
from wct_plugin.batch.summary import causes, headline, ordered, row, to_csv


def record(name: str, code: int) -> Record:
    return Record(name, "1", "2", name, exit_code=code, cause="torn" if code else None)


@pytest.mark.parametrize(
    ("codes", "line"),
    [
        ([], "no files"),
        ([0], "1 file: 1 done"),
        ([2, 0, 1, 0], "4 files: 2 done, 1 goal missed, 1 failed"),
    ],
)
def test_headline(codes, line):
    assert headline([record(f"{k}.vtu", code) for k, code in enumerate(codes)]) == line


def test_failures_stand_last():
    records = [record("a.vtu", 2), record("c.vtu", 0), record("b.vtu", 0)]
    assert [one.input for one in ordered(records)] == ["b.vtu", "c.vtu", "a.vtu"]
    assert causes(records) == [("a.vtu", "torn")]


def test_a_number_that_is_not_finite_is_left_out():
    one = Record("a.vtu", "1", "2", "a.vtu", exit_code=0, before={"min_height": None}, after={"min_height": 0.5})
    assert row(one)[5] == "0.500"
    assert "None" not in to_csv([one])
    with pytest.raises(ValueError, match="not JSON compliant"):
        replace(one, before={"min_height": float("nan")}).to_json()
