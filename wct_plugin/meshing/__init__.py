"""The Python half of the remesher: which surface it follows, its starts, its search, what is carried over."""
