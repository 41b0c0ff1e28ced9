"""The equations of a body as CasADi expressions: manifold, tree of joints, recursions, points."""
