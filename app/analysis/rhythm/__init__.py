"""Beats: from a recording, from the motion, or given by the client."""
