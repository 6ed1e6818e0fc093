"""Files changed by libFuzzer, which sees what each change reaches: ``python -m benchmarks.fuzz.guided obj [FLAG...]``.

It takes the package ``atheris``, which only some systems have wheels of: ``pip install atheris``. What it finds lies as
``crash-…`` in the working directory; its flags are those of libFuzzer, as ``-max_total_time=60``.
"""

import importlib
import inspect
import sys
import tempfile
import types
import warnings
from pathlib import Path
from typing import Any

import wct_plugin as wct
from benchmarks.fuzz import seed_files
from benchmarks.fuzz.judge.said import faults_of_message
from wct_plugin.io.formats import FORMATS


def _instrument(atheris: Any) -> None:
    """Let all functions of readers say where they are; imports that are redirected escape atheris's own way."""
    for name, module in list(sys.modules.items()):
        if not name.startswith(("wct_plugin.io", "wct_plugin.mesh")):
            continue
        for thing in [
            module,
            *(one for _, one in inspect.getmembers(module, inspect.isclass) if one.__module__ == name),
        ]:
            for key, value in list(vars(thing).items()):
                if isinstance(value, types.FunctionType) and value.__module__ == name:
                    setattr(thing, key, atheris.instrument_func(value))


def main() -> None:
    """Change the seed files of one format for as long as the flags say."""
    import atheris

    suffix, *flags = sys.argv[1:]
    for form in FORMATS:
        importlib.import_module(f"wct_plugin.io.{form.reader}")
    _instrument(atheris)
    warnings.simplefilter("ignore")
    place = Path(tempfile.mkdtemp(prefix="wct-guided-"))
    corpus = place / "corpus"
    corpus.mkdir()
    for number, seed in enumerate(seed_files.made(Path("build/fuzz/seeds"))):
        path = seed_files.main_file(seed)
        if path.name == f"main.{suffix}":
            (corpus / str(number)).write_bytes(path.read_bytes())
    path = place / f"main.{suffix}"

    def one(data: bytes) -> None:
        path.write_bytes(data)
        try:
            wct.read(path)
        except wct.WctError as error:
            if faults := faults_of_message(str(error), f"{path}: "):
                raise RuntimeError(f"{faults[0]}: {error}") from error

    atheris.Setup([sys.argv[0], *flags, "-max_len=20000", str(corpus)], one)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
