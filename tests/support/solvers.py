"""``devsim`` and ``fipy``, which cannot be imported as they are.

DEVSIM wants a LAPACK to be named before, and the wheel of cvxopt has one. FiPy uses parts of NumPy that are on their
way out, which would be errors here.
"""

import importlib
import os
import warnings
from pathlib import Path

import cvxopt

(_LAPACK,) = (Path(cvxopt.__file__).parents[1] / "cvxopt.libs").glob("libopenblas*")
os.environ.setdefault("DEVSIM_MATH_LIBS", str(_LAPACK))
devsim = importlib.import_module("devsim")
with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)
    fipy = importlib.import_module("fipy")
