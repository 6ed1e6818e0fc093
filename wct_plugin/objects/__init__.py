"""Meshes as other libraries hold them, made into ours and back; a module per library, imported when it is needed."""
