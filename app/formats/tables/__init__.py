"""Tables of markers in text: CSV of Motive and Nexus, TSV of QTM, and what TRC shares with them."""
