"""The demo library: generated motions that look like recorded motions of people."""

from app.demo.clip import DemoClip
from app.demo.library import demo_clips, write_demo

__all__ = ["DemoClip", "demo_clips", "write_demo"]
