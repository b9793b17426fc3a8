// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/distribution.hpp"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/triangular.hpp>
#include <cmath>

namespace gridspace::launcher {
namespace {

using Normal = boost::math::normal_distribution<>;

double share_below(Normal const& normal, double x) {
    return std::isfinite(x) ? boost::math::cdf(normal, x) : x < 0 ? 0 : 1;
}

} // namespace

double normal_share(Distribution const& d) {
    Normal const normal{d.mean, d.deviation};
    return share_below(normal, d.high) - share_below(normal, d.low);
}

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
    Normal const normal{d.mean, d.deviation};
    return std::clamp(boost::math::quantile(normal, share_below(normal, d.low) + u * normal_share(d)), d.low, d.high);
}

} // namespace gridspace::launcher
