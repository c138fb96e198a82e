"""The motion that a motion symbol generates."""

from __future__ import annotations

from collections.abc import Iterator

from pydantic import Field

from app.analysis.symbols.channels import CHANNELS
from app.api.schemas.base import Outgoing
from app.api.schemas.views import Motion, plain
from app.services.views.symbol_motion import SymbolMotionView


class Channel(Outgoing):
    """One of the 26 channels over time."""

    name: str = Field(examples=["left_knee_flexion"])
    mean: list[float] = Field(
        description="One value per frame: cosine, body lengths, body lengths / s or radians / s."
    )
    spread: list[float] = Field(description="Standard deviation at each frame, in the same unit.")


class SymbolMotion(Motion):
    """The motion that the symbol of a clip generates (Takano, fig. 6)."""

    states: int = Field(description="Number of states of the hidden Markov model.")
    channels: list[Channel]


def channels_json(view: SymbolMotionView) -> Iterator[str]:
    """Yield the member `channels` as JSON, one channel at a time.

    A long clip has a million numbers, so the list is never built as a whole.
    """
    generated = view.generated
    yield ', "channels": ['
    for number, (name, mean, spread) in enumerate(
        zip(CHANNELS, generated.means.T, generated.spreads.T, strict=True)
    ):
        channel = Channel(name=name, mean=plain(mean), spread=plain(spread))
        yield ("," if number else "") + channel.model_dump_json()
    yield "]"
