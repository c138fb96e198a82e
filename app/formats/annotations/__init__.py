"""Files of annotations: spans of time with words, in the formats of other tools."""
