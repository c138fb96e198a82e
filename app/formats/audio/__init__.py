"""Sound files: WAV, FLAC, OGG and MP3."""
