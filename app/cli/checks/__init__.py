"""The checks of `kinedex doctor`."""
