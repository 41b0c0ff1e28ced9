"""A person or a result in MeshCat's own viewer, opened from Python or shown in a notebook."""
