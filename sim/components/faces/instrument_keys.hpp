// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <string>

/// Keys that current and voltage transformers have in common.
namespace gridspace::sim {

struct InstrumentFilter {
    enum class Shape { none, butterworth2 } shape{Shape::none};
    double cutoff_hz{0};

    void read(config::Fields& f, std::string const& name);
    /// 0: no filter.
    [[nodiscard]] double cutoff() const { return shape == Shape::none ? 0 : cutoff_hz; }
};

/// Primary and secondary value, of a text like "400:5".
void read_ratio(config::Fields& f, std::string& text, double& primary, double& secondary, std::string_view doc,
                std::string const& example);

} // namespace gridspace::sim
