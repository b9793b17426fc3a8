// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/faces/instrument_keys.hpp"

#include "sim/components/faces/number_specs.hpp"

#include <charconv>
#include <fmt/format.h>

namespace gridspace::sim {

void read_ratio(config::Fields& f, std::string& text, double& primary, double& secondary, std::string_view doc,
                std::string const& example) {
    f.text("ratio", text, {.doc = doc});
    std::size_t const colon = text.find(':');
    auto const part = [](std::string_view digits, double& value) {
        auto const [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        return error == std::errc{} && end == digits.data() + digits.size() && value > 0;
    };
    if (colon == std::string::npos || !part(std::string_view{text}.substr(0, colon), primary) ||
        !part(std::string_view{text}.substr(colon + 1), secondary)) {
        f.error("ratio", fmt::format("'{}' is not a ratio", text), example);
    }
}

void InstrumentFilter::read(config::Fields& f, std::string const& name) {
    f.choice<Shape>("filter", shape, {{"none", Shape::none}, {"butterworth2", Shape::butterworth2}},
                    {.doc = "anti-alias filter"});
    f.number("cutoff_hz", cutoff_hz, elements::positive("of the filter, -3 dB"));
    if ((shape == Shape::none) != !f.has("cutoff_hz")) {
        f.error(f.has("cutoff_hz") ? "cutoff_hz" : "filter",
                shape == Shape::none ? fmt::format("'{}' has a cutoff_hz but no filter", name)
                                     : fmt::format("the filter of '{}' needs cutoff_hz", name),
                "filter: butterworth2 with cutoff_hz, or neither");
    }
}

} // namespace gridspace::sim
