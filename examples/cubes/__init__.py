"""Parts of ``examples/cube_search.py``. The cube is centred: its faces lie at plus and minus one half."""
