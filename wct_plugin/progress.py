"""Where long work stands, and how it is asked to stop."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """Where a long filter stands: ``done`` in 0..1, ``bad`` the tets that miss the goal so far (None: unknown)."""

    stage: str
    done: float
    bad: int | None = None
    expected: int | None = None  #: tets of the mesh that is being made, about (None: unknown)
    number: int = 0  #: of the stage of a pipeline that is at work, from 1 (0: it is no pipeline)
    count: int = 0  #: stages of that pipeline


#: Called now and then during long work; returning False stops it and keeps the best so far.
ProgressCallback = Callable[[Progress], bool | None]

#: What may be given for ``progress``: True prints where the work stands.
ProgressChoice = ProgressCallback | bool | None
