"""Results in the files of other programs: laboratories' C3D, animation's BVH and glTF."""
