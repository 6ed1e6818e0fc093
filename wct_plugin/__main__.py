"""``python -m wct_plugin``: the command ``wct``."""

from wct_plugin.cli.entry import main

if __name__ == "__main__":
    main()
