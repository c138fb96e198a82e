"""TRC: the marker file of OpenSim."""
