# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""The types of Gridspace's topics: `from gridspace.types import BusMeasurement`. Each is made from its IDL when it is asked for."""
from gridspace.launcher import Error
from gridspace.samples import sample_type


def __getattr__(name: str):
    if name.startswith("_"):
        raise AttributeError(name)
    try:
        return sample_type(name)
    except Error as e:
        raise AttributeError(str(e)) from e
