"""The neighbours, one per file: what leaves the house and what comes in. Each is imported when first needed."""
