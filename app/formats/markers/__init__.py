"""Labeled markers of any format, and the joints of a body that are computed from them."""
