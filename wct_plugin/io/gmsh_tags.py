"""Tags as gmsh can have them: it takes a number below 0 for the one above, with cells turned round."""

from collections.abc import Mapping

import numpy as np

from wct_plugin.types import Ints


def positive(tags: Ints, dimension: int, names: Mapping[str, tuple[int, int]]) -> tuple[Ints, dict[int, int]]:
    """Tags with those below 0, such as MED's families, above: their absolute value, or the next number that is free.

    Gives the tags, and of each that changed what it is now.
    """
    found = np.unique(tags).tolist()
    taken = {tag for tag in found if tag > 0} | {tag for tag, of in names.values() if of == dimension and tag > 0}
    changed: dict[int, int] = {}
    for tag in (tag for tag in reversed(found) if tag < 0):
        changed[tag] = -tag if -tag not in taken else max(taken) + 1
        taken.add(changed[tag])
    if not changed:
        return tags, changed
    values, place = np.unique(tags, return_inverse=True)
    return np.array([changed.get(tag, tag) for tag in values.tolist()], dtype=np.int64)[place.ravel()], changed
