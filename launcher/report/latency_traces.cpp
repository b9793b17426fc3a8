// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/latency_traces.hpp"

#include "launcher/folder/write_file.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <string>
#include <string_view>

namespace gridspace::launcher {
namespace {

constexpr std::string_view kBegin = "stream.", kEnd = ".wire_delay_ms";

} // namespace

Result<std::vector<std::filesystem::path>> write_latency_traces(SignalStore const& signals,
                                                                std::filesystem::path const& folder) {
    std::vector<std::filesystem::path> out;
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    for (auto const& [name, series] : signals) {
        if (!name.starts_with(kBegin) || !name.ends_with(kEnd) || series.values.empty()) {
            continue;
        }
        std::string stream = name.substr(kBegin.size(), name.size() - kBegin.size() - kEnd.size());
        std::ranges::replace(stream, '/', '_');
        std::string table = "time_s,latency_us\n", trace;
        for (std::size_t i = 0; i < series.values.size(); ++i) {
            double const us = series.values[i] * 1e3;
            table += fmt::format("{:.9f},{:.3f}\n", static_cast<double>(series.times_ns[i]) * 1e-9, us);
            trace += fmt::format("{}\n", std::llround(us));
        }
        for (auto const& [ending, text] : {std::pair{".csv", &table}, {".svtrace", &trace}}) {
            out.push_back(folder / (stream + ending));
            if (auto ok = replace_file(out.back(), *text); !ok) {
                return std::unexpected{ok.error()};
            }
        }
    }
    return out;
}

} // namespace gridspace::launcher
