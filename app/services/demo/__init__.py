"""The demo library: motions of our own making that look like people."""

from app.services.demo.library import DemoClip, demo_clips, write_demo

__all__ = ["DemoClip", "demo_clips", "write_demo"]
