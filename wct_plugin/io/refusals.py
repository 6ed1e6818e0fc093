"""Whatever goes wrong in a reader is one line that says which format the file is not."""

import contextlib
from collections.abc import Iterator

from wct_plugin.errors import InputError
from wct_plugin.io.formats import Format


@contextlib.contextmanager
def refusing(form: Format) -> Iterator[None]:
    """Whatever goes wrong in reading a file is an :class:`InputError` of one line; the file's name is left to add."""
    try:
        yield
    except (InputError, OSError) as error:
        raise InputError(f"cannot be read as {form.name}: {_first_line(error)}") from error
    except MemoryError as error:
        said = f": {_first_line(error)}" if str(error) else ""
        raise InputError(f"cannot be read as {form.name}: ran out of memory{said}") from error
    except Exception as error:  # any at all: readers index and convert without looking
        said = f"malformed or truncated ({type(error).__name__}: {_first_line(error)})"
        raise InputError(f"cannot be read as {form.name}: {said}") from error


def _first_line(error: BaseException) -> str:
    return " ".join(str(error).split("\n", 1)[0].split())[:200]
