// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/certify/binomial_interval.hpp"

#include <boost/math/distributions/binomial.hpp>

namespace gridspace::launcher {

Proportion clopper_pearson(std::size_t successes, std::size_t of, double confidence) {
    Proportion out{successes, of, 0, 0, 1};
    if (of == 0) {
        return out;
    }
    using Binomial = boost::math::binomial_distribution<double>;
    auto const k = static_cast<double>(successes), n = static_cast<double>(of);
    double const tail = (1 - confidence) / 2;
    out.estimate = k / n;
    out.low = Binomial::find_lower_bound_on_p(n, k, tail); // 0 and 1 at the ends
    out.high = Binomial::find_upper_bound_on_p(n, k, tail);
    return out;
}

} // namespace gridspace::launcher
