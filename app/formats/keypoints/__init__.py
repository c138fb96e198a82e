"""JSON of 3-D keypoints: OpenPose, MMPose, EasyMocap and alike."""
