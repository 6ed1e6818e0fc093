"""Voxels from .npy, from files of many pages and from folders of images."""

import sys

import numpy as np
import pytest
from PIL import Image

from wct_plugin.errors import InputError, WctError
from wct_plugin.io import voxel_image

VOXELS = np.random.default_rng(3).integers(0, 250, (4, 3, 11), dtype=np.uint8)  # x, y, z


def slices(values=VOXELS):
    return [Image.fromarray(np.ascontiguousarray(values[:, :, k].T)) for k in range(values.shape[2])]


def test_npy(tmp_path):
    np.save(tmp_path / "v.npy", VOXELS)
    assert np.array_equal(voxel_image.read(str(tmp_path / "v.npy")), VOXELS)


@pytest.mark.parametrize("values", [VOXELS, VOXELS > 100, VOXELS.astype(np.uint16) * 200], ids=["8", "1", "16"])
def test_a_file_of_many_pages(tmp_path, values):
    first, *others = slices(values)
    first.save(tmp_path / "v.tif", save_all=True, append_images=others)
    found = voxel_image.read(str(tmp_path / "v.tif"))
    assert found.dtype.kind == values.dtype.kind
    assert np.array_equal(found, values)


def test_a_folder_in_the_order_of_its_numbers(tmp_path):
    for k, image in enumerate(slices()):
        image.save(tmp_path / f"slice{k}.png")  # 10 comes after 9
    (tmp_path / "notes.txt").write_text("not an image")
    assert np.array_equal(voxel_image.read(str(tmp_path)), VOXELS)


def test_what_cannot_be_read(tmp_path):
    def refused(path, message, kind=InputError):
        with pytest.raises(kind, match=message) as error:
            voxel_image.read(str(path))
        assert str(path) in str(error.value)
        assert "\n" not in str(error.value)

    refused(tmp_path / "no.npy", "no such file or folder")
    refused(tmp_path, "the folder holds no image; allowed are .png")
    (tmp_path / "v.npy").write_bytes(b"nothing")
    refused(tmp_path / "v.npy", "no array can be read")
    (tmp_path / "v.stl").write_bytes(b"nothing")
    refused(tmp_path / "v.stl", r"unknown suffix '.stl'; allowed are .npy .tif")
    (tmp_path / "v.tif").write_bytes(b"nothing")
    refused(tmp_path / "v.tif", "no image can be read")
    folder = tmp_path / "folder"
    folder.mkdir()
    Image.new("L", (4, 3)).save(folder / "a.png")
    Image.new("L", (4, 5)).save(folder / "b.png")
    refused(folder, "the images have 4 x 3 and 4 x 5 pixels; all must have the same")
    Image.new("RGB", (4, 3)).save(folder / "b.png")
    with pytest.raises(InputError, match=r"b.png: has 3 channels; voxels need images of one"):
        voxel_image.read(str(folder))


def test_without_pillow_images_are_refused(tmp_path, monkeypatch):
    slices()[0].save(tmp_path / "v.tif")
    monkeypatch.setitem(sys.modules, "PIL", None)
    with pytest.raises(WctError, match=r"images need Pillow: pip install '\.\[images\]' in a clone"):
        voxel_image.read(str(tmp_path / "v.tif"))
