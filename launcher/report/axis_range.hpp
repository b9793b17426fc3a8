// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/report/figure.hpp"

namespace gridspace::launcher {

/// Of an axis of values; of a logarithmic one their decimal logarithms.
struct AxisRange {
    double low{0}, high{1};
};

/// On the axis: the value, or its logarithm. Nothing that was counted is drawn half a one down.
[[nodiscard]] double on_axis(Figure const& figure, double value);

/// What the axis at the left or at the right has to show.
[[nodiscard]] AxisRange range_of(Figure const& figure, bool right);

} // namespace gridspace::launcher
