"""A file is written whole or not at all, and what cannot be written is refused early."""

import os
from pathlib import Path

import pytest

from wct_plugin.errors import OutputError
from wct_plugin.io.atomic_files import check_writable, noting, replacing


def test_what_can_be_written_passes_and_leaves_nothing(tmp_path: Path) -> None:
    check_writable(tmp_path / "new.vtu")
    assert os.listdir(tmp_path) == []
    (tmp_path / "old.vtu").write_text("old")
    check_writable(tmp_path / "old.vtu")
    assert (tmp_path / "old.vtu").read_text() == "old"


def test_a_directory_and_a_missing_directory_are_named(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"is a directory; a file name is needed"):
        check_writable(tmp_path)
    with pytest.raises(OutputError, match=r"there is no directory .*missing; create it first"):
        check_writable(tmp_path / "missing" / "a.vtu")


def test_a_place_that_takes_no_files_is_found_even_by_root() -> None:
    with pytest.raises(OutputError, match=r"/proc/a\.vtu: cannot be written: "):
        check_writable("/proc/a.vtu")


def test_the_result_appears_whole_and_alone(tmp_path: Path) -> None:
    target = tmp_path / "a.vtu"
    with replacing(target) as path:
        path.write_text("half")
        assert path.suffix == ".vtu"
        assert not target.exists()
        path.write_text("whole")
    assert target.read_text() == "whole"
    assert os.listdir(tmp_path) == ["a.vtu"]


def test_companions_come_along_under_their_own_names(tmp_path: Path) -> None:
    with replacing(tmp_path / "part.1.ele") as path:
        path.write_text("tets")
        path.with_suffix(".node").write_text("points")
    assert sorted(os.listdir(tmp_path)) == ["part.1.ele", "part.1.node"]


@pytest.mark.parametrize("trouble", [ValueError, KeyboardInterrupt, SystemExit])
def test_trouble_leaves_the_old_file_and_nothing_else(tmp_path: Path, trouble: type[BaseException]) -> None:
    target = tmp_path / "a.vtu"
    target.write_text("old")
    with pytest.raises(trouble), replacing(target) as path:  # noqa: PT012
        path.write_text("new")
        path.with_suffix(".h5").write_text("new")
        raise trouble
    assert target.read_text() == "old"
    assert os.listdir(tmp_path) == ["a.vtu"]


def test_a_full_disk_is_reported_and_leaves_nothing(small_disk: Path) -> None:
    (small_disk / "a.vtu").write_text("old")
    with (
        pytest.raises(OutputError, match=r"a\.vtu: cannot be written: No space left on device"),
        replacing(small_disk / "a.vtu") as path,
    ):
        path.write_bytes(bytes(200_000))
    assert (small_disk / "a.vtu").read_text() == "old"
    assert os.listdir(small_disk) == ["a.vtu"]


def test_a_directory_of_that_name_or_of_a_companions_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.vtu").mkdir()
    with pytest.raises(OutputError, match="is a directory"), replacing(tmp_path / "a.vtu") as path:
        path.write_text("new")
    (tmp_path / "b.h5").mkdir()
    with pytest.raises(OutputError, match=r"there is a directory named b\.h5"), replacing(tmp_path / "b.xdmf") as path:  # noqa: PT012
        for file in (path, path.with_suffix(".h5")):
            file.write_text("new")
    assert sorted(os.listdir(tmp_path)) == ["a.vtu", "b.h5"]


def test_a_body_that_writes_nothing_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="nothing was written"), replacing(tmp_path / "a.vtu"):
        pass


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "real.vtu").write_text("old")
    (tmp_path / "link.vtu").symlink_to("real.vtu")
    with replacing(tmp_path / "link.vtu") as path:
        path.write_text("new")
    assert (tmp_path / "link.vtu").is_symlink()
    assert (tmp_path / "real.vtu").read_text() == "new"


def test_what_got_its_name_is_noted_by_the_callers_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("real.vtu").write_text("old")
    Path("link.vtu").symlink_to("real.vtu")
    with replacing("before.vtu") as path:
        path.write_text("new")
    with noting() as written:
        for name in ("b.ele", "link.vtu", "a.vtu", "a.vtu"):
            with replacing(name) as path:
                path.write_text("new")
                if name == "b.ele":
                    path.with_suffix(".node").write_text("new")
        with pytest.raises(KeyboardInterrupt), replacing("c.vtu"):
            raise KeyboardInterrupt
    with replacing("after.vtu") as path:
        path.write_text("new")
    assert written.names() == ["b.node", "b.ele", "link.vtu", "a.vtu"]


def test_an_interrupt_before_or_after_the_renaming_does_not_deceive(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a.vtu").write_text("old")
    rename = Path.replace
    for renamed in (False, True):

        def interrupted(file: Path, target: Path, renamed: bool = renamed) -> None:
            if renamed:
                rename(file, target)
            raise KeyboardInterrupt

        monkeypatch.setattr(Path, "replace", interrupted)
        with noting() as written, pytest.raises(KeyboardInterrupt), replacing(tmp_path / "a.vtu") as path:
            path.write_text("new")
        assert written.names() == [str(tmp_path / "a.vtu")] * renamed
        assert (tmp_path / "a.vtu").read_text() == ("new" if renamed else "old")


def test_an_interrupt_as_the_workplace_is_made_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    make = Path.mkdir

    def interrupted(folder: Path, *args: int, **kwargs: int) -> None:
        make(folder, *args, **kwargs)  # type: ignore[arg-type]
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "mkdir", interrupted)
    with pytest.raises(KeyboardInterrupt), replacing(tmp_path / "a.vtu"):
        pass
    assert os.listdir(tmp_path) == []
