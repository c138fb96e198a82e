"""How answers are made: problems, and motions written piece by piece."""
