"""Pages and pictures: the 3-D scene, the live page, playback, reports, films and figures."""
