"""Batches of small meshes, and their manifests."""

import json

import wct_plugin as wct

QUALITY = wct.Filter.get_quality(worst=1)


def lines(folder, name="manifest.jsonl"):
    return [json.loads(line) for line in (folder / name).read_text().splitlines()]
