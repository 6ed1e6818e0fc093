"""The manifest: wherever a commit is broken off, it is gone on with, and what is not finished is taken away."""

import json
import os
from dataclasses import replace

import pytest

from wct_plugin.batch.job import OUTPUT, RECORD, Job, Record, digest
from wct_plugin.batch.manifest import Manifest
from wct_plugin.errors import OptionError


@pytest.fixture
def manifest(tmp_path):
    made = Manifest(tmp_path)
    made.open(resume=False)
    yield made
    made.close()


def attempt(manifest, name="a.vtu", finished=True, **changes):
    """An attempt as a job leaves it: its output, and if it is finished its record."""
    folder = manifest.work / f"{name}.{len(list(manifest.work.iterdir()))}"
    (folder / OUTPUT).mkdir(parents=True)
    (folder / OUTPUT / name).write_text("mesh")
    (folder / OUTPUT / "a.h5").write_text("companion")
    made = {file.name: digest(file) for file in (folder / OUTPUT).iterdir()}
    record = replace(Record("a.stl", "1", "2", name, made, 0), **changes)
    if finished:
        (folder / RECORD).write_text(record.to_json())
    return record, folder


def lines(manifest):
    return [json.loads(line) for line in manifest.path.read_text().splitlines()]


def reopened(manifest):
    """What the next run finds; the lock of one that was killed goes with it."""
    manifest.close()
    manifest.open(resume=True)


def killed(manifest):
    """The same after a kill, which leaves the folder of work."""
    os.close(manifest._file)
    manifest._file = None
    manifest.open(resume=True)


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_a_finished_attempt_is_committed_by_the_next_run(manifest, tmp_path):
    record, _ = attempt(manifest)
    attempt(manifest, "half.vtu", finished=False)
    killed(manifest)
    assert names(tmp_path) == [".wct-batch", "a.h5", "a.vtu", "manifest.jsonl"]
    assert names(manifest.work) == []
    assert [Record.from_json(json.dumps(line)).files for line in lines(manifest)] == [record.files]


def test_a_commit_broken_off_between_outputs_and_line(manifest, tmp_path):
    _, folder = attempt(manifest)
    (folder / OUTPUT / "a.h5").rename(tmp_path / "a.h5")
    killed(manifest)
    assert len(lines(manifest)) == 1
    _, folder = attempt(manifest, "b.vtu")
    for file in list((folder / OUTPUT).iterdir()):
        file.rename(tmp_path / file.name)
    killed(manifest)
    assert {line["output"] for line in lines(manifest)} == {"a.vtu", "b.vtu"}


def test_a_commit_broken_off_behind_the_line(manifest):
    record, folder = attempt(manifest)
    manifest.commit(record, None)
    assert folder.exists()
    killed(manifest)
    assert len(lines(manifest)) == 1
    assert not folder.exists()


def test_a_job_finished_twice_is_one_line(manifest):
    record, folder = attempt(manifest)
    attempt(manifest, cpu_seconds=1.0)
    manifest.commit(record, folder)
    manifest.close()
    assert len(lines(manifest)) == 1


def test_a_failure_writes_no_output_and_is_outdone_by_a_success(manifest, tmp_path):
    record, folder = attempt(manifest, exit_code=2, cause="no", files={})
    manifest.commit(record, folder)
    assert not (tmp_path / "a.vtu").exists()
    attempt(manifest)
    killed(manifest)
    assert [line["exit_code"] for line in lines(manifest)] == [2, 0]
    assert (tmp_path / "a.vtu").exists()


def test_finished_asks_for_input_pipeline_and_outputs(manifest, tmp_path):
    source = tmp_path / "in.stl"
    source.write_text("surface")
    record, folder = attempt(manifest, input_sha256=digest(source))
    manifest.commit(record, folder)
    job = Job(str(source), "a.vtu", [], "2", str(tmp_path), str(manifest.work))
    assert manifest.finished(job) == record
    assert manifest.finished(replace(job, pipeline_sha256="3")) is None
    assert manifest.finished(replace(job, name="b.vtu")) is None
    (tmp_path / "a.h5").write_text("spoiled")
    assert manifest.finished(job) is None
    (tmp_path / "a.h5").write_text("companion")
    reopened(manifest)
    assert manifest.finished(job) is not None
    source.write_text("another")
    assert manifest.finished(job) is None


def test_what_other_shards_left_is_finished_unless_they_are_at_work(manifest, tmp_path):
    other = Manifest(tmp_path, "-1of2")
    other.open(resume=True)
    attempt(other)
    reopened(manifest)
    assert lines(manifest) == []  # it is at work
    os.close(other._file)
    reopened(manifest)
    assert [line["output"] for line in lines(manifest)] == ["a.vtu"]
    assert not other.work.exists()


def test_a_shard_leaves_what_another_left_to_that_one(tmp_path):
    first, second = Manifest(tmp_path, "-1of2"), Manifest(tmp_path, "-2of2")
    first.open(resume=False)
    attempt(first)
    os.close(first._file)  # killed
    second.open(resume=True)
    assert len(names(first.work)) == 1
    first.open(resume=True)
    assert [line["output"] for line in lines(first)] == ["a.vtu"]
    first.close()
    second.close()


def test_a_manifest_of_an_earlier_batch_is_not_overwritten(manifest, tmp_path):
    manifest.close()
    for part in ("", "-1of2"):
        with pytest.raises(OptionError, match=r"manifest.jsonl exists: --resume goes on"):
            Manifest(tmp_path, part).open(resume=False)


def test_without_resume_no_record_of_another_shard_counts(tmp_path):
    first, second = Manifest(tmp_path, "-1of2"), Manifest(tmp_path, "-2of2")
    first.open(resume=False)
    first.commit(*attempt(first))
    job = Job("a.stl", "a.vtu", [], "2", str(tmp_path), str(second.work))
    second.open(resume=False)  # side by side with the first
    assert second.count([job]) == 0
    second.close()
    second.open(resume=True)
    assert second.count([job]) == 1
    second.close()
    first.close()
    with pytest.raises(OptionError, match=r"manifest-1of2.jsonl exists: --resume goes on"):
        Manifest(tmp_path).open(resume=False)


def test_a_record_survives_the_journey(manifest):
    record, _ = attempt(manifest, warnings=("ü\n",), metrics={"a": [1.5, None]}, goals=({"goal": "3wc"},))
    back = Record.from_json(record.to_json())
    assert "\n" not in record.to_json()
    assert json.loads(back.to_json()) == json.loads(record.to_json())


def test_ctrl_c_while_a_line_is_written_does_not_write_it_twice(manifest, monkeypatch):
    def interrupted(_):
        monkeypatch.undo()
        raise KeyboardInterrupt

    record, folder = attempt(manifest)
    monkeypatch.setattr(os, "fsync", interrupted)
    with pytest.raises(KeyboardInterrupt):
        manifest.commit(record, folder)
    manifest.close()
    assert len(lines(manifest)) == 1
