"""Ready-made pipelines that come with the package, in ``presets/``; they hold filters only, so that any file fits."""

from pathlib import Path

from wct_plugin.errors import InputError
from wct_plugin.pipeline import json_form
from wct_plugin.pipeline.stage import did_you_mean

_FOLDER = Path(__file__).with_name("presets")


def names() -> list[str]:
    """The ready-made pipelines."""
    return sorted(file.stem for file in _FOLDER.glob("*.json"))


def description(name: str) -> str:
    """What a ready-made pipeline is for, in one line."""
    return str(json_form.load(read(name))["description"])


def read(name: str | Path) -> bytes:
    """Content of a pipeline's file, or where there is no such file of the ready-made pipeline of that name."""
    file = Path(name)
    if not file.exists() and str(name) in names():
        file = _FOLDER / f"{name}.json"
    try:
        return file.read_bytes()
    except FileNotFoundError as error:
        known = names()
        hint = did_you_mean(str(name), known)
        raise InputError(f"{name}: no such file{hint} (ready-made pipelines: {', '.join(known)})") from error
    except IsADirectoryError as error:
        raise InputError(f"{name}: is a directory; the name of a pipeline's file is needed") from error
    except OSError as error:
        raise InputError(f"{name}: cannot be read: {error.strerror or error}") from error
