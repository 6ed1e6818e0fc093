"""Which names of tags a format can have, and what becomes of tags where it has names alone."""

import re
from collections.abc import Mapping, Sequence

import numpy as np

from wct_plugin.io import abaqus_names, gmsh_tags, med_families, su2
from wct_plugin.io.assembly import TAG_SET
from wct_plugin.io.blocks import Block
from wct_plugin.io.formats import Format

Names = dict[str, tuple[int, int]]  #: tag and dimension


#: Characters that no XML file may have, spelled in whatever way.
_NO_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


def fitting(form: Format, blocks: Sequence[Block], names: Mapping[str, tuple[int, int]]) -> Names:
    """Those of the names that the format can have; where it has one for each tag, the first."""
    match form.name:
        case "MED":
            return _one_each({name: pair for name, pair in names.items() if med_families.fits(name) and pair[0]})
        case "SU2":
            there = {tag for block in blocks if block.dimension == 2 for tag in np.unique(block.tags).tolist()}
            return _one_each(
                {
                    name: (tag, of)
                    for name, (tag, of) in names.items()
                    if of == 2 and tag in there and su2.can_name(name)
                }
            )
    able = fits_xml if form.name == "VTU" else bool
    return {name: pair for name, pair in names.items() if form.names and not set('"\n\\') & set(name) and able(name)}


def fits_xml(name: str) -> bool:
    """Whether XML has all characters of a name: of those that control something it has blanks alone."""
    return not _NO_XML.search(name)


def _one_each(names: Names) -> Names:
    first = {pair: name for name, pair in reversed(names.items())}
    return {name: pair for name, pair in names.items() if first[pair] == name}


def with_positive_tags(blocks: Sequence[Block], names: Mapping[str, tuple[int, int]]) -> tuple[Names, list[str]]:
    """Give the blocks tags that gmsh can have.

    Returns the names with these, and what the tags without names were and are: nothing else in the file tells.
    """
    found = dict(names)
    lost = []
    for block in blocks:
        block.tags, changed = gmsh_tags.positive(block.tags, block.dimension, names)
        of_block = {name: tag for name, (tag, of) in names.items() if of == block.dimension}
        found |= {name: (changed[tag], block.dimension) for name, tag in of_block.items() if tag in changed}
        unnamed = [f"{tag} is {now}" for tag, now in changed.items() if tag not in of_block.values()]
        if unnamed:
            lost.append(f"tags below 0 of {block.kind} cells ({', '.join(unnamed)})")
    return found, lost


def as_sets(blocks: Sequence[Block], names: Mapping[str, tuple[int, int]]) -> tuple[Names, list[str]]:
    """Make sets of the tags, for Abaqus, which has none: under their names, else by number.

    Returns the names that are kept so, and comments with the numbers of their tags.
    """
    usable = _one_each({name: pair for name, pair in names.items() if abaqus_names.fits(name)})
    kept: Names = {}
    comments = []
    for block in blocks:
        called = {tag: name for name, (tag, of) in usable.items() if of == block.dimension}
        for tag in np.unique(block.tags[block.tags != 0]).tolist():
            members = np.flatnonzero(block.tags == tag)
            name = called.pop(tag, "")
            given = block.sets.get(name)
            if name and (given is None or np.array_equal(np.sort(given), members)):
                block.sets[name] = members
                kept[name] = (tag, block.dimension)
                comments.append(abaqus_names.tag_comment(name, tag, block.dimension, is_set=given is not None))
            else:
                block.sets[f"{TAG_SET}{block.kind}_{tag}"] = members
                usable.pop(name, None)
    sets = {name for block in blocks for name in block.sets}
    for name, (tag, dimension) in usable.items():  # names that no cell has
        if name not in kept and name not in sets:
            kept[name] = (tag, dimension)
            comments.append(abaqus_names.tag_comment(name, tag, dimension, is_set=False))
    return kept, comments
