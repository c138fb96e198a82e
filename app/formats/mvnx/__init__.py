"""MVNX: the XML file of Xsens (Movella) MVN."""
