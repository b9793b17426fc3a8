// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/distribution.hpp"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/triangular.hpp>
#include <cmath>

namespace gridspace::launcher {

double quantile(Distribution const& d, double u) {
    switch (d.kind) {
    case Distribution::Kind::uniform:
        return d.low + u * (d.high - d.low);
    case Distribution::Kind::log_uniform:
        return std::exp(std::log(d.low) + u * (std::log(d.high) - std::log(d.low)));
    case Distribution::Kind::triangular:
        return boost::math::quantile(boost::math::triangular_distribution<>{d.low, d.mode, d.high}, u);
    case Distribution::Kind::normal:
        break;
    }
    boost::math::normal_distribution<> const normal{d.mean, d.deviation};
    double const below = std::isfinite(d.low) ? boost::math::cdf(normal, d.low) : 0;
    double const up_to = std::isfinite(d.high) ? boost::math::cdf(normal, d.high) : 1;
    return std::clamp(boost::math::quantile(normal, below + u * (up_to - below)), d.low, d.high);
}

} // namespace gridspace::launcher
