"""The queue's consumer: each task is one service call."""
