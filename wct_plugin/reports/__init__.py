"""What is said of a mesh: text, JSON, HTML."""
