"""Look at a clip: motion, keyposes, segments, exports, low-dimensional motion."""
