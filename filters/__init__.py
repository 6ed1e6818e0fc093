"""One filter per file; each is found through its entry point in the group ``wct_plugin.filters``."""
