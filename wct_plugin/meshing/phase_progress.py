"""Progress of the remesher: what the core says of each phase, handed on to the caller."""

from wct_plugin.progress import Progress, ProgressCallback


class Listener:
    """Passes the core's progress on under one name per phase, with the bad tets of the best mesh so far."""

    def __init__(self, progress: ProgressCallback, bad: int) -> None:
        self._progress = progress
        self._bad = bad
        self._expected: int | None = None
        self.stopped = not self._tell("resampling", 0.0)

    def _tell(self, stage: str, done: float) -> bool:
        return self._progress(Progress(stage, done, self._bad, self._expected)) is not False

    def expect(self, tets: int) -> bool:
        """About how many tets the new mesh will have."""
        self._expected = tets
        return self.resample(0.0, 0)

    def resample(self, done: float, bad: int) -> bool:
        """Until the search takes the new mesh over, the best so far is the input."""
        self.stopped = self.stopped or not self._tell("resampling", done)
        return not self.stopped

    def conform(self, done: float, bad: int) -> bool:
        """Bad tets of the best mesh so far."""
        self._bad = bad
        self.stopped = self.stopped or not self._tell("conforming", done)
        return not self.stopped

    def search(self, phase: str, done: float, bad: int) -> bool:
        """Bad tets of the search's best mesh, or those short of the margin."""
        if phase != "margin":  # there, all that can meet the goal do
            self._bad = bad
        stage = f"local search: margin, {bad} tets short of it" if phase == "margin" else f"local search: {phase}"
        self.stopped = self.stopped or not self._tell(stage, done)
        return not self.stopped

    def measure(self, bad: int) -> None:
        """What the mesh given back has."""
        self._bad = bad
        self._tell("measuring", 1.0)
