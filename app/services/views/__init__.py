"""Views of a clip: motion, keyposes, segments, exports, low-dimensional motion."""
