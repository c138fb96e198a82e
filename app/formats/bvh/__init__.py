"""BVH: a reader of all known dialects, a writer, and the export of animations."""
