"""What can go wrong, as the user sees it: every message is one line that names what was found and what is allowed."""


class WctError(Exception):
    """Base of every error this package raises on purpose."""


class InputError(WctError):
    """A file or mesh that cannot be used: it names the file or element, the value found and what is allowed."""


class NoMeshError(InputError):
    """Arrays that make no mesh: an index out of range, a flat tet, three tets at a facet."""


class ObjectError(InputError, TypeError):
    """An object that no mesh can be made of, or a mesh that cannot be made such an object; it names what can."""


class OptionError(WctError):
    """An unknown stage or option, a value out of range, or stages that do not fit together."""


class FractionError(OptionError):
    """A value out of range of an option that is a fraction of the bounding-box diagonal: most likely a length."""

    def __init__(self, message: str, value: float, most: float | None) -> None:
        super().__init__(message)
        self.value = value
        self.most = most  #: that is allowed


class OutputError(WctError):
    """A result that could not be written; nothing is left behind under the target's name."""


class NeighbourError(WctError):
    """An external mesher or library that failed, ran out of time or gave an unusable result."""


class InternalError(WctError):
    """A fault of this package or of a filter, not of what it was given: please report it."""


class WctWarning(UserWarning):
    """Something the user had that could not be carried along; the message names it."""


def how_to_install(extra: str) -> str:
    """The command that installs a part of this package, which no registry has: it is for a clone."""
    return f"pip install '.[{extra}]' in a clone of wct_plugin"


def one_line(error: BaseException) -> str:
    """What to tell the user about anything raised: one line, which says so where it is a fault of ours."""
    message = " ".join(str(error).split())
    ours = isinstance(error, InternalError)
    if isinstance(error, WctError) and not ours:
        return message
    if isinstance(error, MemoryError):
        return f"ran out of memory{f': {message}' if message else ''}"
    where = " ".join(["internal error", *getattr(error, "__notes__", [])])
    return f"{where}, please report it: {message if ours else f'{type(error).__name__}: {message}'}"
