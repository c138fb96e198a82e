"""What the symbol space keeps of the divergences is told by dimensions and by way."""

from __future__ import annotations

from itertools import pairwise

import pytest

from app.errors import NotEnoughLabels
from app.models.held_out.symbols import SymbolFigures, symbol_figures
from tests.models.word_clips import word_clips


@pytest.fixture(scope="module")
def found() -> SymbolFigures:
    symbols, _, _ = word_clips(4)
    return symbol_figures(symbols, compared=6)


def test_more_dimensions_lower_the_error(found: SymbolFigures) -> None:
    errors = [each.s_stress for each in found.errors]
    assert [each.dimensions for each in found.errors] == list(range(1, len(errors) + 1))
    assert errors[-1] < 0.5 * errors[0]
    assert all(after <= before * 1.02 for before, after in pairwise(errors))
    assert found.errors[-1].gamma is None


def test_the_error_of_the_paper_is_lowest_for_the_method_that_minimizes_it(
    found: SymbolFigures,
) -> None:
    short_of_exact = found.errors[:-1]  # as many dimensions as points leave nothing but rounding
    assert all(each.s_stress <= each.classical for each in short_of_exact)
    # Each finds a minimum near its start, seldom not the lowest one.
    assert sum(e.s_stress for e in found.errors) < sum(e.smacof for e in found.errors)


def test_new_symbols_are_placed_nearly_as_well_as_landmarks(found: SymbolFigures) -> None:
    assert 0.0 <= found.fitting_error <= found.placing_error < 0.3


def test_the_fast_divergence_ranks_as_monte_carlo_does(found: SymbolFigures) -> None:
    assert found.agreement > 0.95
    assert found.pairs == 6 * 5


def test_too_few_symbols_are_refused() -> None:
    symbols, _, _ = word_clips(1)
    with pytest.raises(NotEnoughLabels):
        symbol_figures(symbols[:4])
