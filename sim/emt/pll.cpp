// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/pll.hpp"

#include <cmath>

namespace gridspace::sim::emt {
void Pll::start(double alpha, double beta) {
    double const size = std::sqrt(alpha * alpha + beta * beta);
    w_ = w0_;
    ahead_h_ = -1;
    integral_ = 0;
    cos_ = size > kNoVoltage ? alpha / size : 1;
    sin_ = size > kNoVoltage ? beta / size : 0;
}

} // namespace gridspace::sim::emt
