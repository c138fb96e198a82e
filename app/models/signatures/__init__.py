"""What the multilinear model holds, to look at and to play: signatures, actions, eigenmotions."""
