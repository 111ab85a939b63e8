"""Small records of whole numbers that Python and compiled functions share, with named fields."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any, Self, get_type_hints

import numpy as np

if TYPE_CHECKING:  # numpy's types call its records final; numpy itself lets them be derived from
    Base = object
else:
    Base = np.record


class Record(Base):
    """A record of int64 fields; a subclass declares them as annotations, `name: int`.

    Names of methods that numpy scalars have, as `sum`, are none for fields.

    Compiled functions get it by reference: what they write shows in Python.
    """

    @classmethod
    @cache
    def layout(cls) -> np.dtype[Any]:
        """The fields as a numpy type."""
        return np.dtype((cls, [(name, np.int64) for name in get_type_hints(cls)]))

    @classmethod
    def of(cls, **values: int) -> Self:
        """A record with some values, and 0 in all other fields."""
        record: Self = np.zeros(1, cls.layout())[0]
        for name, value in values.items():
            setattr(record, name, value)
        return record
