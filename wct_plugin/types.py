"""Array types and the metrics of a filter, by short names."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: What a filter found out: names and JSON-able values.
Metrics = dict[str, Any]
