"""What is drawn on a canvas, as people see it."""

from __future__ import annotations

from playwright.sync_api import Locator

COLORS = """async (bytes) => {
  const image = await createImageBitmap(new Blob([new Uint8Array(bytes)]));
  const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
  context.drawImage(image, 0, 0);
  const {data} = context.getImageData(0, 0, image.width, image.height);
  return new Set(new Uint32Array(data.buffer)).size;
}"""


def colors_of(picture: Locator) -> int:
    """How many colors a picture has: one is an empty canvas."""
    colors: int = picture.page.evaluate(COLORS, list(picture.screenshot()))
    return colors
