"""The grammar ``NAME=VALUE,NAME=VALUE`` of options that say something else for each group, set or tag."""

#: Stands for all that is not named.
REST = "*"


def parse(text: str) -> dict[str, str]:
    """Names and values of ``text``, in its order; a name may hold an equals sign, though no comma.

    Raises :class:`ValueError` for what is no NAME=VALUE, and for a name that is there twice.
    """
    found: dict[str, str] = {}
    for piece in text.split(","):
        name, equals, value = (part.strip() for part in piece.rpartition("="))
        if not (equals and name and value):
            raise ValueError(f"must be NAME=VALUE,NAME=VALUE; {piece.strip()!r} is no NAME=VALUE")
        if name in found:
            raise ValueError(f"says twice what {name!r} is")
        found[name] = value
    return found
