# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables of hourly values: a column `hour` (0, 1, 2 … since the start of the run), and columns of numbers."""
import csv
import pathlib


class Hourly:
    """The columns of a table as lists of one value an hour. Raises ValueError with file and line for a mistake in it."""

    def __init__(self, file, columns):
        self.file = pathlib.Path(file)
        self.columns = {name: [] for name in columns}
        with self.file.open(newline="") as stream:
            rows = csv.DictReader(stream)
            missing = [name for name in ("hour", *columns) if name not in (rows.fieldnames or [])]
            if missing:
                raise ValueError(f"{self.file}:1: there is no column '{missing[0]}'; there are {', '.join(rows.fieldnames or ['none'])}")
            for hour, row in enumerate(rows):
                where = f"{self.file}:{rows.line_num}"
                if row["hour"] != str(hour):
                    raise ValueError(f"{where}: hour is '{row['hour']}', expected {hour}")
                for name, values in self.columns.items():
                    try:
                        values.append(float(row[name]))
                    except (TypeError, ValueError):
                        raise ValueError(f"{where}: {name} is '{row[name]}', expected a number") from None
        if not self.columns or not all(self.columns.values()):
            raise ValueError(f"{self.file}: there is no hour in it")

    def at(self, column, time_s):
        """The value of the hour that a simulated time is in; after the last hour that of the last."""
        values = self.columns[column]
        return values[min(int(time_s // 3600), len(values) - 1)]


def tariff(file):
    """Prices in EUR/kWh of what is taken from the grid and of what is given to it."""
    return Hourly(file, ("import_eur_per_kwh", "export_eur_per_kwh"))


def forecast(file):
    """Powers in kW."""
    return Hourly(file, ("pv_kw", "wind_kw", "load_kw"))
