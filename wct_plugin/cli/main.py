"""``wct``: parses and prints, nothing else.

Exit codes as in ruff: 0 done and goal met, 1 done and goal missed (the output is written), 2 usage, input, crash or
interrupt. Results go to stdout; progress, warnings and errors to stderr, errors as one line, which names what was
written before.
"""

import os
import sys
import warnings
from collections.abc import Sequence
from contextlib import suppress

import click

from wct_plugin.cli.commands import Commands
from wct_plugin.cli.interrupt import raised_in_the_end
from wct_plugin.cli.messages import FAILED, GOAL_MET, fail, show_warning, showing_notes
from wct_plugin.cli.save_case import Case, noting_case
from wct_plugin.errors import InternalError, WctError, WctWarning, one_line
from wct_plugin.io import atomic_files
from wct_plugin.io.standard_streams import ReaderGoneError


@click.group(cls=Commands, context_settings={"max_content_width": 100})
def cli() -> None:
    """Make tetrahedral meshes well-centered, and say how well-centered they are."""


def run(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and give its exit code; errors are printed as one line, with what was written before."""
    with atomic_files.noting() as written, noting_case() as case:
        try:
            with raised_in_the_end(), warnings.catch_warnings(), showing_notes():
                warnings.simplefilter("ignore")  # other packages' warnings are for programmers
                warnings.simplefilter("always", WctWarning)
                warnings.showwarning = show_warning
                code = cli.main(args=arguments, prog_name="wct", standalone_mode=False)
        except click.exceptions.NoArgsIsHelpError as error:
            with suppress(OSError):  # standard error that takes nothing changes no exit code
                click.echo(error.format_message(), err=True)
            return FAILED
        except click.ClickException as error:
            message = error.format_message()
        except InternalError as error:
            message = _crash(error, case, arguments)
        except ReaderGoneError:  # who has read enough, as head does, wants no message
            return FAILED
        except WctError as error:
            message = str(error)
        except (KeyboardInterrupt, click.Abort):
            message = "interrupted" if written.names() else "interrupted; nothing was written"
        except MemoryError as error:
            message = one_line(error)
        except Exception as error:
            message = _crash(error, case, arguments)
        else:
            return code if isinstance(code, int) else GOAL_MET
        before = ", ".join(written.names())
        return fail(f"{message}; written before: {before}" if before else message)


def _crash(error: Exception, case: Case, arguments: Sequence[str] | None) -> str:
    """What is said of a bug of ours: still one line, still exit code 2; the case and the traceback on request."""
    saved = case.save(error, sys.argv[1:] if arguments is None else arguments)
    if os.environ.get("WCT_TRACEBACK"):
        raise error
    return f"{one_line(error)}; {saved} (WCT_TRACEBACK=1 shows where)"
