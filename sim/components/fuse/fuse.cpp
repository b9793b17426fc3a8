// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/fuse/fuse.hpp"

#include "sim/components/faces/number_specs.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace gridspace::sim {

using namespace elements;

void FuseType::fields(Fields& f) {
    f.number("rated_a", rated_a, positive("it carries this current for ever, r.m.s.", true));
    f.numbers("melting_a", melting_a, positive("currents of the melting curve, r.m.s., rising", true));
    f.numbers("melting_s", melting_s, positive("time until a link melts at each of them", true));
    f.number("i2t_a2s", i2t_a2s,
             positive("pre-arcing integral of times below a period; without it that of the last point"));
    f.number("arcing_ms", arcing_ms, not_negative("from melting until the arc can go out"));
    f.choice<Opens>(
        "opens", opens, {{"each_pole_at_current_zero", Opens::each_pole_at_current_zero}, {"at_once", Opens::at_once}},
        {.doc = "when the arc goes out: at the next current zero (expulsion), or at once (current limiting)"});
    if (melting_a.size() != melting_s.size() || melting_a.size() < 2) {
        f.error(
            "melting_s",
            fmt::format("fuse type '{}' has {} currents and {} times", name.name, melting_a.size(), melting_s.size()),
            "expected as many times as currents, at least 2");
        return;
    }
    for (std::size_t i = 1; i < melting_a.size(); ++i) {
        if (melting_a[i] <= melting_a[i - 1] || melting_s[i] >= melting_s[i - 1]) {
            f.error(
                melting_a[i] <= melting_a[i - 1] ? "melting_a" : "melting_s",
                fmt::format("the melting curve of fuse type '{}' goes from {:.4g} A, {:.4g} s to {:.4g} A, {:.4g} s",
                            name.name, melting_a[i - 1], melting_s[i - 1], melting_a[i], melting_s[i]),
                "expected rising currents and falling times");
            return;
        }
    }
    if (rated_a >= melting_a.front()) {
        f.error("rated_a",
                fmt::format("fuse type '{}' melts at {:.4g} A and is rated {:.4g} A", name.name, melting_a.front(),
                            rated_a),
                "expected less than the first of `melting_a`, the minimum melting current");
    }
    double const last_a2s = melting_a.back() * melting_a.back() * melting_s.back();
    if (i2t_a2s && *i2t_a2s > last_a2s * (1 + 1e-9)) {
        f.error("i2t_a2s",
                fmt::format("an I2t of {:.4g} A2s is more than the {:.4g} A2s of the last point of the curve", *i2t_a2s,
                            last_a2s),
                "I2t falls towards short times: expected at most that of the last point");
    }
}

void FuseType::check(ElementCheck& check) const {
    if (melting_a.size() < 2 || melting_a.size() != melting_s.size()) {
        return; // said before
    }
    double const least_a2s = melting_a.front() * melting_a.front() / check.around().frequency_hz();
    if (adiabatic_a2s() <= least_a2s) {
        check.wrong(fmt::format("melts at an I2t of {:.4g} A2s, which {:.4g} A bring in a period ({:.4g} A2s)",
                                adiabatic_a2s(), melting_a.front(), least_a2s),
                    "a larger `i2t_a2s`, or a smaller minimum melting current (the first of `melting_a`)");
    }
}

double FuseType::melting_time_s(double i_a) const {
    if (!(i_a >= melting_a.front())) {
        return std::numeric_limits<double>::infinity();
    }
    auto const next = std::upper_bound(melting_a.begin(), melting_a.end(), i_a);
    if (next == melting_a.end()) {
        double const ratio = melting_a.back() / i_a;
        return melting_s.back() * ratio * ratio;
    }
    auto const i = static_cast<std::size_t>(next - melting_a.begin());
    double const share = std::log(i_a / melting_a[i - 1]) / std::log(melting_a[i] / melting_a[i - 1]);
    return melting_s[i - 1] * std::pow(melting_s[i] / melting_s[i - 1], share);
}

void Fuse::fields(Fields& f) {
    line_end(f, end);
    f.reference("type", type, {.doc = "fuse type", .required = true});
}

emt::Opening Fuse::opening(Surroundings const& around) const {
    FuseType const* found = around.find<FuseType>(type);
    return found == nullptr
               ? emt::Opening{}
               : emt::Opening{.after_s = found->arcing_ms * 1e-3, .at_once = found->opens == FuseType::Opens::at_once};
}

} // namespace gridspace::sim
