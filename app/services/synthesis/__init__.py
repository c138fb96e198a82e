"""Make a motion that was not recorded."""
