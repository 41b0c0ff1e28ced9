"""Films of the 3-D view, drawn picture by picture in a browser without a window."""
