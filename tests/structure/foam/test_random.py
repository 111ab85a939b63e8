import numpy as np

from v3dcad.structure.foam.random import random_bits, random_share


def test_the_numbers_of_splitmix64():
    """The first ones of the authors' generator for this state."""
    state = np.array([1234567], np.uint64)
    expected = [6457827717110365317, 3203168211198807973, 9817491932198370423]
    assert [int(random_bits(state)) for _ in expected] == expected


def test_shares_are_even():
    state = np.array([7], np.uint64)
    shares = np.array([random_share(state) for _ in range(20_000)])
    assert shares.min() >= 0
    assert shares.max() < 1
    counts = np.histogram(shares, bins=20, range=(0, 1))[0]
    assert np.abs(counts - 1000).max() < 5 * np.sqrt(1000)
