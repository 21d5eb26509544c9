"""The exact facts of networks: by hand, by Euler's formula, and by counts of ends."""

from fractions import Fraction

import numpy as np
import pytest
from networks.planar import Subdivision, facts
from networks.random_networks import KINKS, kink_placements, kinks, random_network

H, V = [(0.0, 0.5), (1.0, 0.5)], [(0.25, 0.0), (0.25, 1.0)]
LOOP = [(0.25, 0.25), (0.75, 0.25), (0.75, 0.75), (0.25, 0.75), (0.25, 0.25)]
INNER = [(0.375, 0.375), (0.625, 0.375), (0.5, 0.625), (0.375, 0.375)]


@pytest.mark.parametrize(
    "cracks, areas, tips, mouths, t_ends, crossings",
    [
        ([H, V], [1 / 8, 1 / 8, 3 / 8, 3 / 8], 0, 4, 0, 1),
        ([H, [(0.5, 0.5), (0.5, 0.75)]], [1 / 2, 1 / 2], 1, 2, 1, 0),
        ([LOOP, INNER], [1 / 32, 7 / 32, 3 / 4], 0, 0, 0, 0),
        ([LOOP, [(0.5, 0.125), (0.5, 0.5)]], [1 / 4, 3 / 4], 2, 0, 0, 1),
        ([LOOP, [(0.0, 0.5), (0.25, 0.5)], [(0.5, 0.25), (0.5, 0.75)]], [1 / 8, 1 / 8, 3 / 4], 0, 1, 3, 0),
        ([[(0.25, 0.5), (0.75, 0.5)], [(0.5, 0.25), (0.5, 0.75)], [(0.375, 0.375), (0.625, 0.625)]], [1], 6, 0, 0, 1),
    ],
)
def test_networks_by_hand(cracks, areas, tips, mouths, t_ends, crossings):
    found = facts(cracks)
    assert [float(a) for a in found.areas] == areas and found.blocks == len(areas)
    assert (found.tips, found.mouths, found.t_ends, found.crossings) == (tips, mouths, t_ends, crossings)


def test_distances_and_angles():
    found = facts([[(0.25, 0.5), (0.75, 0.5)], [(0.5, 0.4375), (0.75, 0.1875)], [(0.25, 0.5), (0.5, 0.75)]])
    assert (found.closest, found.length) == (0.0625, 0.5 + np.sqrt(2) / 2) and np.isclose(found.sharpest, 45)


def test_what_overlaps_is_refused():
    with pytest.raises(ValueError, match="overlap"):
        facts([H, [(0.25, 0.5), (0.5, 0.5), (0.5, 0.75)]])
    with pytest.raises(ValueError, match="multiples"):
        facts([[(0.0, 2.0**-70), (0.5, 0.5)]])


@pytest.mark.parametrize("seed", range(12))
def test_random_networks(seed):
    """Blocks traced face by face are those of Euler's formula, and fill the square; every end is of one kind."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 13))
    cracks, found = random_network(rng, n, separation=0.005 * (seed % 2), angle=5 * (seed % 2))
    assert len(cracks) == n and found.blocks == len(found.areas) and sum(found.areas) == Fraction(1) and found.areas[0] > 0
    assert found.tips + found.mouths + found.t_ends == 2 * sum(crack[0] != crack[-1] for crack in cracks)
    assert found.closest > 0.005 * (seed % 2) and found.sharpest > 5 * (seed % 2)
    assert all(KINKS[0] <= k <= KINKS[1] for crack in cracks for k in kinks(crack))
    assert facts([crack[::-1] for crack in reversed(cracks)]).areas == found.areas


def test_random_networks_have_everything():
    networks = [random_network(np.random.default_rng(seed), 8) for seed in range(12)]
    total = {name: sum(getattr(found, name) for _, found in networks) for name in ("tips", "mouths", "t_ends", "crossings")}
    assert min(total.values()) >= 12 and sum(crack[0] == crack[-1] for cracks, _ in networks for crack in cracks) >= 3
    assert max(len(Subdivision(cracks).passes) for cracks, _ in networks) > 20 and max(found.blocks for _, found in networks) >= 4
    assert any(len(crack) > 4 and crack[0] != crack[-1] for cracks, _ in networks for crack in cracks)


@pytest.mark.parametrize("angle", [20, 90, 150])
def test_kinks(angle):
    placements = kink_placements(np.random.default_rng(1), angle, 50)
    assert np.allclose([kinks(crack) for crack in placements], angle)
    turns = [np.cross([*np.subtract(b, a), 0], [*np.subtract(c, b), 0])[2] for a, b, c in placements]
    assert 10 < sum(turn > 0 for turn in turns) < 40 and all(0 < c < 1 for crack in placements for p in crack for c in p)
