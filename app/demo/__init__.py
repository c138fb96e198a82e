"""The demo library: motions of our own making that look like people."""

from app.demo.clip import DemoClip
from app.demo.library import demo_clips, write_demo

__all__ = ["DemoClip", "demo_clips", "write_demo"]
