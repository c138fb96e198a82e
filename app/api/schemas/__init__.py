"""What goes over the wire, field by field; never a row by reflection."""
